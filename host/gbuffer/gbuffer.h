#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "host/gbuffer/channel_roles.h"
#include "host/gbuffer/view.h"
#include "host/scene/rectangle.h"

namespace mica::host {

/// What a G-buffer tells of the point that the ray through a pixel's centre meets.
struct BufferPixel {
  static constexpr std::int32_t kNothing = -1;
  std::int32_t material = kNothing;  ///< index into SceneDescription::materials; of nothing the rest is unset
  Eigen::Vector3f position{0, 0, 0};
  Eigen::Vector3f normal{0, 0, 1}, face_normal{0, 0, 1};  ///< unit: smooth over the shape, and of its surface
  Eigen::Vector3f tangent{0, 0, 0};                       ///< towards +u, of any length; zero: not known
  /// Change of position a unit of u and of v in the plane of the surface; zero: not known.
  Eigen::Matrix<float, 3, 2> dpduv = Eigen::Matrix<float, 3, 2>::Zero();
  Eigen::Vector2f uv{0, 0};
  bool is_broken = false;  ///< it is nothing because numbers of it are none
};

/// Pixels of some rows, and of all columns, row by row.
struct BufferRows {
  Rectangle<BufferPixel> pixels;
  /// By row, column and lamp: the sum over R, G and B of its light on a white diffuse surface; none: not
  /// known.
  std::vector<Rectangle<float>> lamp_light;
};

struct BufferOptions {
  std::vector<BufferPreset> presets;
  std::vector<std::string> channels;  ///< by hand, see find_buffer_channels
  bool skips_other_ids = false;       ///< ids that no material has are nothing
};

/// A file of the surface points that another renderer saw, one a pixel.
class GBuffer {
 public:
  /// Opens the file and reads its ids. Throws as find_buffer_channels, and FileError: a resolution that is
  /// not the view's, ids that are averages of a filter, or that no material has.
  /// @param scale pixels of the buffer a pixel of the layer along each axis.
  GBuffer(const std::string& path, const BufferView& view, const std::vector<MaterialDescription>& materials,
          int scale, const BufferOptions& options);

  const FileWindow& window() const { return file_.window(); }
  std::map<std::string, std::string> metadata() const { return file_.metadata(); }
  const std::vector<std::string>& notes() const { return notes_; }
  /// Whether the light of a lamp is known where nothing but shadows takes from it.
  bool knows_shadows_of(std::size_t lamp) const { return !lamp_channels_[lamp].empty(); }

  /// Rows [first_row, first_row + row_count), which may lie outside the file, and `margin` columns of nothing
  /// on both sides. Throws FileError: damaged pixels, normals that are averages of a filter, positions that
  /// the camera does not see in their pixels.
  BufferRows read(int first_row, int row_count, int margin);

 private:
  void find_lamps(const BufferView& view);
  void read_ids(const std::vector<MaterialDescription>& materials, bool skips_other_ids);
  std::int32_t material_of(float id, int row, int column) const;
  BufferPixel pixel_of(const float* values, int row, int column) const;
  void check_place(const BufferPixel& pixel, int row, int column) const;
  std::string place(int row, int column) const;

  ChannelFile file_;
  const BufferCamera camera_;
  BufferChannels channels_;
  std::vector<std::vector<int>> lamp_channels_;  // by lamp
  std::map<std::int64_t, std::int32_t> material_of_id_;
  std::vector<std::string> notes_;
};

}  // namespace mica::host
