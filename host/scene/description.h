#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "host/base/glints_description.h"
#include "host/base/words.h"
#include "host/image/picture.h"

namespace mica::host {

class MethodSettings;

/// Linear RGB, or any per-channel triple.
using Color = Eigen::Vector3d;

struct CameraDescription {
  Eigen::Vector3d position{0, -3, 1};
  Eigen::Vector3d look_at{0, 0, 0};
  Eigen::Vector3d up{0, 0, 1};
  double fov_degrees = 40;  ///< vertical
};

struct ConductorFresnel {
  Color eta{0.2, 0.92, 1.1};
  Color k{3.9, 2.45, 2.1};
};
struct DielectricFresnel {
  double ior = 1.5;
};
/// Schlick's approximation with a colour at normal incidence.
struct ColorFresnel {
  Color color{1, 1, 1};
};
using Fresnel = std::variant<ConductorFresnel, DielectricFresnel, ColorFresnel>;

/// A clear layer over a material: dielectric, thin beside everything else, itself a little rough.
struct CoatDescription {
  double ior = 1.5;
  double roughness = 0.02;  ///< standard deviation of its own slopes an axis; 1e-3..1
};

/// What becomes of light that bounces more than once between the facets of a lobe.
enum class MultipleScattering {
  lost,
  kept  ///< it leaves as what bounced once, see LobeEnergy
};
template <>
struct Words<MultipleScattering> {
  static constexpr Word<MultipleScattering> all[] = {{"lost", MultipleScattering::lost},
                                                     {"kept", MultipleScattering::kept}};
};

/// `[material.NAME]`
struct MaterialDescription {
  std::string name;
  std::string surface;                                       ///< name of a surface
  Eigen::Vector2d repeat{1, 1};                              ///< map periods over the shape's uv
  std::string ndf = "auto";                                  ///< name of the method
  std::shared_ptr<const MethodSettings> settings = nullptr;  ///< the method's own
  double roughness = 0.01;  ///< sigma_r on the disk; of a long one the root mean square
  std::optional<Eigen::Vector2d> long_roughness = {};  ///< along u and v, where these differ
  Fresnel specular = ColorFresnel{};
  Color diffuse{0, 0, 0};  ///< Lambertian albedo
  MultipleScattering multiple_scattering = MultipleScattering::lost;
  std::optional<CoatDescription> coat = {};
  std::optional<GlintsDescription> glints = {};  ///< for methods that have no map
  std::optional<int> id = {};                    ///< its number in the buffers of another renderer, above 0

  Eigen::Vector2d roughness_uv() const {
    return long_roughness.value_or(Eigen::Vector2d::Constant(roughness));
  }
};

struct PlaneShape {  ///< square of the plane z = height, uv over its sides
  Eigen::Vector3d center{0, 0, 0};
  double size = 10;
};
struct SphereShape {
  Eigen::Vector3d center{0, 0, 0};
  double radius = 1;
};
struct ShellShape {  ///< snail shell: a tube along a logarithmic spiral, standing on z = 0
  Eigen::Vector3d center{0, 0, 0};
  double size = 1.1;  ///< height of the bounding box
  double turns = 4.5;
};
struct MeshShape {  ///< Wavefront OBJ with uv
  std::string path;
};
struct JarShape {  ///< a round jar with a lid, standing on z = 0; parts "body" and "lid"
  Eigen::Vector3d center{0, 0, 0};
  double size = 1;  ///< height with the lid
};
struct SpoonShape {  ///< lying on z = 0 along x, its bowl towards +x and open upwards
  Eigen::Vector3d center{0, 0, 0};
  double size = 2;  ///< length
};
struct ForkShape {  ///< lying on z = 0 along x, its tines towards +x
  Eigen::Vector3d center{0, 0, 0};
  double size = 2;  ///< length
};

/// Where a shape stands: stretched along its own axes, then turned, then moved.
struct Placement {
  Eigen::Vector3d scale{1, 1, 1};           ///< above 0
  Eigen::Vector3d rotate_degrees{0, 0, 0};  ///< about x, then y, then z; counterclockwise seen from its tip
  Eigen::Vector3d translate{0, 0, 0};
};

/// Material of one named part of a shape.
struct PartMaterial {
  std::string part, material;
};

/// `[[shape]]`. Shapes of equal geometry share it in memory.
struct ShapeDescription {
  std::variant<PlaneShape, SphereShape, ShellShape, MeshShape, JarShape, SpoonShape, ForkShape> geometry;
  std::string material;
  Placement placement = {};
  std::vector<PartMaterial> parts = {};  ///< that have another material than the rest
};

struct PointLight {
  Eigen::Vector3d position{0, 0, 4};
  Color intensity{10, 10, 10};  ///< W/sr
};
struct DirectionalLight {
  Eigen::Vector3d direction{0, 0, -1};  ///< in which the light travels
  Color irradiance{3, 3, 3};            ///< W/m^2 on a surface that faces it
  double angular_radius = 0;            ///< radians, of the disk that shines; it widens lobes alone
};
struct SphereLight {  ///< shines alike in all directions
  Eigen::Vector3d position{0, 0, 4};
  double radius = 0.2;
  Color intensity{10, 10, 10};  ///< W/sr
};
struct DiskLight {  ///< one-sided, as bright from every angle
  Eigen::Vector3d position{0, 0, 4};
  Eigen::Vector3d direction{0, 0, -1};  ///< that it faces
  double radius = 0.5;
  Color intensity{10, 10, 10};  ///< W/sr along its direction
};
/// `[[light]]`
using LightDescription = std::variant<PointLight, DirectionalLight, SphereLight, DiskLight>;

/// `[[light]]` that shines from all around and from far away: `environment` is a lat-long image, oriented as
/// that of Background; `furnace`, without a path, is the same radiance in all directions.
struct EnvironmentLight {
  std::string path;
  Color radiance{1, 1, 1};      ///< W/(m^2 sr); what the image is multiplied with
  double rotation_degrees = 0;  ///< turns the image about +z, from +x towards +y
  PictureChoice choice = {};
  TexelRepair invalid = TexelRepair::repair;
};

/// What rays that hit nothing see: a colour, or a lat-long image when `path` is not empty.
struct BackgroundDescription {
  Color color{0, 0, 0};
  std::string path;
  bool is_environment = false;  ///< the scene's environment lights instead
  PictureChoice choice = {};
  TexelRepair invalid = TexelRepair::repair;
};

/// What a camera or a light is at one frame.
template <class Described>
struct Keyframe {
  double frame;
  Described value;
};
/// By increasing frame; empty for what does not move.
template <class Described>
using Keyframes = std::vector<Keyframe<Described>>;

struct SceneDescription {
  CameraDescription camera;
  std::vector<MaterialDescription> materials;
  std::vector<ShapeDescription> shapes;
  std::vector<LightDescription> lights;
  std::vector<EnvironmentLight> environments;
  BackgroundDescription background;
  Keyframes<CameraDescription> camera_keys = {};
  std::vector<Keyframes<LightDescription>> light_keys = {};  ///< by light; lights beyond its end stand still
};

}  // namespace mica::host
