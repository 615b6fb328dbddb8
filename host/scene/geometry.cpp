#include "host/scene/geometry.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "host/scene/fork.h"
#include "host/scene/jar.h"
#include "host/scene/obj.h"
#include "host/scene/placement.h"
#include "host/scene/shell.h"
#include "host/scene/spoon.h"
#include "mica/error.h"

namespace mica::host {
namespace {

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryRelease {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, GeometryRelease>;

void check(RTCDevice device, const char* action) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE)
    throw DeviceError(fmt::format("Embree cannot {}: error {}", action, static_cast<int>(error)));
}

/// What Embree found is made exact by the shape itself.
using Shape = std::variant<PlaneShape, SphereShape, TriangleMesh>;

struct MakeShape {
  Shape operator()(const PlaneShape& plane) const {
    if (!(plane.center.allFinite() && std::isfinite(plane.size) && plane.size > 0))
      throw UsageError("plane: center must be finite and size positive");
    return plane;
  }
  Shape operator()(const SphereShape& sphere) const {
    if (!(sphere.center.allFinite() && std::isfinite(sphere.radius) && sphere.radius > 0))
      throw UsageError("sphere: center must be finite and radius positive");
    return sphere;
  }
  Shape operator()(const ShellShape& shell) const { return make_shell(shell); }
  Shape operator()(const MeshShape& mesh) const { return load_obj(mesh.path); }
  Shape operator()(const JarShape& jar) const { return make_jar(jar); }
  Shape operator()(const SpoonShape& spoon) const { return make_spoon(spoon); }
  Shape operator()(const ForkShape& fork) const { return make_fork(fork); }
};

/// Whether two descriptions are of the same shape; the visitor knows the first one.
struct SameShape {
  const decltype(ShapeDescription::geometry)& other;

  template <class Described>
  bool operator()(const Described& shape) const {
    const Described* same_kind = std::get_if<Described>(&other);
    return same_kind && equal(shape, *same_kind);
  }

 private:
  static bool equal(const MeshShape& a, const MeshShape& b) { return a.path == b.path; }
  static bool equal(const SphereShape& a, const SphereShape& b) {
    return a.center == b.center && a.radius == b.radius;
  }
  static bool equal(const ShellShape& a, const ShellShape& b) {
    return a.center == b.center && a.size == b.size && a.turns == b.turns;
  }
  template <class Described>
  static bool equal(const Described& a, const Described& b) {
    return a.center == b.center && a.size == b.size;
  }
};

template <class Element>
Element* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count) {
  return static_cast<Element*>(rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Element), count));
}

struct MakeEmbreeGeometry {
  RTCDevice device;

  GeometryHandle operator()(const PlaneShape& plane) const {
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD));
    auto* corners = new_buffer<Eigen::Vector3f>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 4);
    auto* quad =
        new_buffer<std::array<unsigned, 4>>(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, 1);
    check(device, "allocate a plane");
    const double half = plane.size / 2;
    const Eigen::Vector3d offsets[] = {
        {-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    for (std::size_t i = 0; i < 4; ++i) corners[i] = (plane.center + offsets[i]).cast<float>();
    *quad = {0, 1, 2, 3};
    return geometry;
  }

  GeometryHandle operator()(const SphereShape& sphere) const {
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT));
    auto* point =
        new_buffer<std::array<float, 4>>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 1);
    check(device, "allocate a sphere");
    const Eigen::Vector3f center = sphere.center.cast<float>();
    *point = {center.x(), center.y(), center.z(), static_cast<float>(sphere.radius)};
    return geometry;
  }

  GeometryHandle operator()(const TriangleMesh& mesh) const {
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* positions = new_buffer<Eigen::Vector3f>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                                                  mesh.positions.size());
    auto* triangles = new_buffer<std::array<std::uint32_t, 3>>(geometry.get(), RTC_BUFFER_TYPE_INDEX,
                                                               RTC_FORMAT_UINT3, mesh.triangles.size());
    check(device, "allocate a mesh");
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    return geometry;
  }
};

void set_ray(RTCRay* to, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_far) {
  to->org_x = static_cast<float>(origin.x());
  to->org_y = static_cast<float>(origin.y());
  to->org_z = static_cast<float>(origin.z());
  to->dir_x = static_cast<float>(direction.x());
  to->dir_y = static_cast<float>(direction.y());
  to->dir_z = static_cast<float>(direction.z());
  to->tnear = 0;
  to->tfar = static_cast<float>(t_far);
  to->time = 0;
  to->mask = ~0u;
  to->id = 0;
  to->flags = 0;
}

void put_ray(const RTCRay& ray, std::size_t n, RTCRay16* packet) {
  packet->org_x[n] = ray.org_x, packet->org_y[n] = ray.org_y, packet->org_z[n] = ray.org_z;
  packet->dir_x[n] = ray.dir_x, packet->dir_y[n] = ray.dir_y, packet->dir_z[n] = ray.dir_z;
  packet->tnear[n] = ray.tnear, packet->tfar[n] = ray.tfar;
  packet->time[n] = ray.time, packet->mask[n] = ray.mask;
  packet->id[n] = ray.id, packet->flags[n] = ray.flags;
}

struct ExactHit {
  const Ray& ray;
  const RTCRayHit& found;
  Hit operator()(const PlaneShape& plane) const { return hit_plane(plane, ray); }
  Hit operator()(const SphereShape& sphere) const { return hit_sphere(sphere, ray, found.ray.tfar); }
  Hit operator()(const TriangleMesh& mesh) const { return hit_triangle(mesh, found.hit.primID, ray); }
};

/// Where single precision has enough room for a shape, its own middle serves as origin if it lies far from
/// there.
constexpr double kFarAway = 64;

/// Moves a shape to where its coordinates are small. @return the origin that it then is relative to.
struct Recentre {
  Eigen::Vector3d operator()(PlaneShape& plane) const { return move(&plane.center, plane.size); }
  Eigen::Vector3d operator()(SphereShape& sphere) const { return move(&sphere.center, sphere.radius); }
  Eigen::Vector3d operator()(const TriangleMesh& mesh) const { return mesh.origin; }

 private:
  static Eigen::Vector3d move(Eigen::Vector3d* center, double extent) {
    if (!(center->cwiseAbs().maxCoeff() > kFarAway * extent)) return Eigen::Vector3d::Zero();
    return std::exchange(*center, Eigen::Vector3d::Zero());
  }
};

struct BoxOf {
  Eigen::AlignedBox3d operator()(const PlaneShape& plane) const {
    const Eigen::Vector3d half(plane.size / 2, plane.size / 2, 0);
    return {plane.center - half, plane.center + half};
  }
  Eigen::AlignedBox3d operator()(const SphereShape& sphere) const {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(sphere.radius);
    return {sphere.center - half, sphere.center + half};
  }
  Eigen::AlignedBox3d operator()(const TriangleMesh& mesh) const {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& position : mesh.positions) box.extend(position.cast<double>());
    return box;
  }
};

/// A shape as it is described, which may stand in several places.
struct Prototype {
  Shape shape;
  Eigen::Vector3d origin;
  GeometryHandle geometry;
  SceneHandle scene;  ///< holds this shape alone, once it stands somewhere else than described
};

struct PlacedShape {
  std::size_t prototype;
  PlacedFrame frame;
};

// More threads would order the triangles differently, and the order decides which of two equally near ones
// is hit.
void commit(RTCScene scene) {
  tbb::task_arena(1).execute([&] { rtcJoinCommitScene(scene); });
}

}  // namespace

Ray ray_from(const Hit& hit, const Eigen::Vector3d& direction) {
  const double side = direction.dot(hit.face_normal) < 0 ? -1 : 1;
  return {hit.position + side * hit.error * hit.face_normal, direction};
}

struct Geometry::Implementation {
  DeviceHandle device;
  SceneHandle scene;
  std::vector<decltype(ShapeDescription::geometry)> descriptions;  ///< one a prototype
  std::vector<Prototype> prototypes;
  std::vector<PlacedShape> placed;  ///< by Embree's geomID, or instID of those that are instances
  Eigen::Vector3d middle{0, 0,
                         0};  ///< of the scene, where Embree has its origin; 0 unless all lies far from there

  std::size_t prototype_of(const ShapeDescription& description) {
    const auto found = std::find_if(descriptions.begin(), descriptions.end(), [&](const auto& other) {
      return std::visit(SameShape{other}, description.geometry);
    });
    if (found != descriptions.end()) return static_cast<std::size_t>(found - descriptions.begin());
    Shape shape = std::visit(MakeShape{}, description.geometry);
    const Eigen::Vector3d origin = std::visit(Recentre{}, shape);
    GeometryHandle geometry = std::visit(MakeEmbreeGeometry{device.get()}, shape);
    rtcCommitGeometry(geometry.get());
    descriptions.push_back(description.geometry);
    prototypes.push_back({std::move(shape), origin, std::move(geometry), nullptr});
    return prototypes.size() - 1;
  }

  SceneHandle new_scene() const {
    SceneHandle made(rtcNewScene(device.get()));
    rtcSetSceneFlags(made.get(), RTC_SCENE_FLAG_ROBUST);
    return made;
  }

  GeometryHandle instance(Prototype* prototype, const PlacedFrame& frame) const {
    if (!prototype->scene) {
      prototype->scene = new_scene();
      rtcAttachGeometry(prototype->scene.get(), prototype->geometry.get());
      commit(prototype->scene.get());
    }
    GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), prototype->scene.get());
    const Eigen::Affine3d to_embree = Eigen::Translation3d(-middle) * frame.to_scene();
    const Eigen::Matrix<float, 3, 4> matrix = to_embree.matrix().topRows<3>().cast<float>();
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
    rtcCommitGeometry(geometry.get());
    return geometry;
  }

  void place(const ShapeDescription& description) {
    const std::size_t index = prototype_of(description);
    placed.push_back({index, PlacedFrame(description.placement, prototypes[index].origin)});
  }

  void set_middle() {
    Eigen::AlignedBox3d box;
    for (const PlacedShape& shape : placed)
      box.extend(std::visit(BoxOf{}, prototypes[shape.prototype].shape).transformed(shape.frame.to_scene()));
    if (!box.isEmpty() && box.center().cwiseAbs().maxCoeff() > 4 * box.sizes().maxCoeff())
      middle = box.center();
  }

  bool is_instance(const PlacedShape& shape) const { return !shape.frame.is_identity() || !middle.isZero(0); }

  void attach(unsigned id) {
    const PlacedShape& shape = placed[id];
    Prototype& prototype = prototypes[shape.prototype];
    if (is_instance(shape))
      rtcAttachGeometryByID(scene.get(), instance(&prototype, shape.frame).get(), id);
    else
      rtcAttachGeometryByID(scene.get(), prototype.geometry.get(), id);
    check(device.get(), "add a shape");
  }
};

Geometry::Geometry(const std::vector<ShapeDescription>& shapes) : implementation_(new Implementation) {
  Implementation& self = *implementation_;
  self.device.reset(rtcNewDevice(nullptr));
  if (!self.device) check(nullptr, "start");
  self.scene = self.new_scene();
  for (const ShapeDescription& shape : shapes) self.place(shape);
  self.set_middle();
  for (unsigned id = 0; id < self.placed.size(); ++id) self.attach(id);
  commit(self.scene.get());
  check(self.device.get(), "build its hierarchy");
}

Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;

const std::vector<std::string>& Geometry::parts(std::size_t shape) const {
  static const std::vector<std::string> none;
  const Implementation& self = *implementation_;
  const auto* mesh = std::get_if<TriangleMesh>(&self.prototypes[self.placed[shape].prototype].shape);
  return mesh ? mesh->parts : none;
}

std::optional<Hit> Geometry::intersect(const Ray& ray) const {
  const Implementation& self = *implementation_;
  RTCRayHit found;
  set_ray(&found.ray, ray.origin - self.middle, ray.direction, std::numeric_limits<float>::infinity());
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(self.scene.get(), &context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const bool is_instance = found.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  const unsigned index = is_instance ? found.hit.instID[0] : found.hit.geomID;
  const PlacedShape& placed = self.placed[index];
  const Shape& shape = self.prototypes[placed.prototype].shape;
  const Ray local = is_instance ? placed.frame.to_shape(ray) : ray;
  Hit hit = std::visit(ExactHit{local, found}, shape);
  // Exactly edge-on there is no point to name.
  if (!hit.position.allFinite() || !hit.face_normal.allFinite()) return std::nullopt;
  if (is_instance) hit = placed.frame.to_scene(hit, self.middle);
  hit.shape = index;
  return hit;
}

bool Geometry::occluded(const Hit& hit, const Eigen::Vector3d& direction, double distance) const {
  RTCRay ray;
  set_ray(&ray, ray_from(hit, direction).origin - implementation_->middle, direction, distance);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(implementation_->scene.get(), &context, &ray);
  return ray.tfar < 0;
}

std::size_t Geometry::count_open(const Hit& hit, const std::vector<ShadowRay>& rays) const {
  constexpr std::size_t packet = 16;
  if (rays.size() == 1) return occluded(hit, rays[0].direction, rays[0].distance) ? 0 : 1;
  std::size_t open = 0;
  for (std::size_t first = 0; first < rays.size(); first += packet) {
    RTCRay16 together;
    alignas(64) int valid[packet];
    for (std::size_t n = 0; n < packet; ++n) {
      // Lanes beyond the end repeat the last ray, and are not asked.
      const ShadowRay& to_light = rays[std::min(first + n, rays.size() - 1)];
      RTCRay ray;
      set_ray(&ray, ray_from(hit, to_light.direction).origin - implementation_->middle, to_light.direction,
              to_light.distance);
      put_ray(ray, n, &together);
      valid[n] = first + n < rays.size() ? -1 : 0;
    }
    // Not said to be coherent: Embree 3.13 may then never return from instances.
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, implementation_->scene.get(), &context, &together);
    for (std::size_t n = 0; n < packet; ++n) open += valid[n] && !(together.tfar[n] < 0);
  }
  return open;
}

}  // namespace mica::host
