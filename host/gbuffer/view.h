#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/camera.h"
#include "host/scene/description.h"

namespace mica::host {

/// The camera of a G-buffer, in the world of its positions.
class BufferCamera {
 public:
  /// What a camera's description says, by the words of Blender.
  struct Description {
    bool is_orthographic = false;
    Eigen::Matrix4d to_world =
        Eigen::Matrix4d::Identity();  ///< of a camera that looks along -z, its top at +y
    double extent = 1;       ///< of the image's fitted side at unit distance; of an orthographic one its own
    bool fits_width = true;  ///< else that side is the height
    Eigen::Vector2d shift{0, 0};  ///< of the image's middle, in fitted sides
    double pixel_aspect = 1;      ///< height of a pixel over its width
  };
  BufferCamera(const Description& camera, int width, int height);

  /// The ray through a point of a surface that pixel coordinates (x, y) show, and how far along it that lies.
  struct Sight {
    CameraRay ray;
    double t;
  };
  Sight sight(const Eigen::Vector3d& position) const;

  /// Where a position is seen, pixels from the left and from the top; none: behind the camera.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& position) const;

 private:
  bool is_orthographic_;
  Eigen::Vector3d position_, right_, up_, forward_;  // unit
  Eigen::Vector2d pixel_;                            // size of one at unit distance
  Eigen::Vector2d middle_;                           // pixel coordinates of the viewing axis
};

/// How a spot lamp fades towards the edge of its cone.
struct SpotCone {
  Eigen::Vector3d position, axis;  ///< axis unit, in which it shines
  double cos_half_angle = 0, blend = 0;
  bool falls_with_cosine = false;  ///< to the axis, besides

  /// Share of its intensity in the direction of a point, [0, 1].
  double share(const Eigen::Vector3d& point) const;
};

struct BufferLamp {
  std::string name;
  LightDescription light;
  std::optional<SpotCone> cone;
};

/// From where a G-buffer was seen, and what lights it.
struct BufferView {
  int width, height;
  BufferCamera camera;
  std::vector<BufferLamp> lamps;
  std::vector<std::string> notes;
};

/// Reads `resolution`, `pixel_aspect`, `camera` and `lamps` of a JSON file, as docs/glints.md lists them.
///
/// Powers are those of Blender: a point or spot of P watts has an intensity of P / (4 pi) in all directions,
/// an area one the radiance P / (pi area), a sun the irradiance P; times 2^exposure and the colour. An area
/// lamp is a disk of the same area. Where the key `blender` names a version before 4 a spot falls with the
/// cosine to its axis. Throws FileError for a file that cannot be read, that is no JSON, or that lacks or has
/// wrong values; the message names them.
BufferView read_view(const std::string& path);

}  // namespace mica::host
