#include "host/scene/obj.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <tuple>

#include "mica/error.h"

namespace mica::host {
namespace {

using Vector3 = Eigen::Vector3d;
using Vector2 = Eigen::Vector2d;

/// One corner of a face: zero-based indices, normal only where the file gives one.
struct Corner {
  std::size_t position, uv;
  std::optional<std::size_t> normal;
};

class ObjReader {
 public:
  explicit ObjReader(const std::string& path) : path_(path) {}

  TriangleMesh read() {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path_, error))
      throw FileError(
          fmt::format("{}: cannot read: {}", path_, error ? error.message() : "not a regular file"));
    std::ifstream stream(path_, std::ios::binary);
    if (!stream) throw FileError(fmt::format("{}: cannot read: {}", path_, std::strerror(errno)));
    for (std::string line; std::getline(stream, line);) {
      ++line_;
      read_statement(line);
    }
    if (stream.bad()) throw FileError(fmt::format("{}: cannot read: {}", path_, std::strerror(errno)));
    if (mesh_.triangles.empty()) throw FileError(fmt::format("{}: holds no faces", path_));
    if (mesh_.parts.size() == 1) mesh_.part_of_triangle.clear();
    set_tangents(&mesh_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw FileError(fmt::format("{}:{}: {}", path_, line_, message));
  }

  static std::vector<std::string_view> words(std::string_view line) {
    constexpr std::string_view blanks = " \t\r";
    line = line.substr(0, line.find('#'));
    std::vector<std::string_view> found;
    for (std::size_t begin = 0; (begin = line.find_first_not_of(blanks, begin)) != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
      found.push_back(line.substr(begin, end - begin));
      begin = end;
    }
    return found;
  }

  void read_statement(std::string_view line) {
    const std::vector<std::string_view> word = words(line);
    if (word.empty()) return;
    constexpr std::string_view passed_over[] = {"g", "o", "s", "l", "p", "mtllib"};
    if (word[0] == "v")
      positions_.push_back(read_vector<3>(word));
    else if (word[0] == "vt")
      uvs_.push_back(read_vector<2>(word));
    else if (word[0] == "vn")
      normals_.push_back(read_vector<3>(word));
    else if (word[0] == "f")
      read_face(word);
    else if (word[0] == "usemtl")
      use_material(word);
    else if (std::find(std::begin(passed_over), std::end(passed_over), word[0]) == std::end(passed_over))
      fail(fmt::format("found the statement '{}', expected v, vt, vn or f", word[0]));
  }

  void use_material(const std::vector<std::string_view>& word) {
    if (word.size() != 2) fail(fmt::format("found {} names after 'usemtl', expected 1", word.size() - 1));
    material_ = std::string(word[1]);
  }

  /// Index of the part that faces now belong to.
  std::uint32_t part() {
    const auto found = std::find(mesh_.parts.begin(), mesh_.parts.end(), material_);
    const auto index = static_cast<std::uint32_t>(found - mesh_.parts.begin());
    if (found == mesh_.parts.end()) mesh_.parts.push_back(material_);
    return index;
  }

  /// The first `size` numbers; OBJ allows more (weights, colours), which say nothing here.
  template <int size>
  Eigen::Matrix<double, size, 1> read_vector(const std::vector<std::string_view>& word) const {
    if (word.size() < size + 1)
      fail(fmt::format("found {} numbers after '{}', expected {}", word.size() - 1, word[0], size));
    Eigen::Matrix<double, size, 1> vector;
    for (int i = 0; i < size; ++i) vector[i] = read_number(word[static_cast<std::size_t>(i) + 1]);
    return vector;
  }

  double read_number(std::string_view text) const {
    constexpr double limit = 1e15;  // far below the coordinates at which single precision overflows
    std::string_view digits = text;
    if (digits.size() > 1 && digits.front() == '+') digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
      fail(fmt::format("found '{}', expected a number", text));
    if (error != std::errc() || !(std::abs(value) <= limit))
      fail(fmt::format("found {}, expected a number between -1e15 and 1e15", text));
    return value;
  }

  /// One-based, or counted back from the latest element when negative.
  std::size_t read_index(std::string_view text, std::size_t count, const char* statement) const {
    long long index = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (error != std::errc() || end != text.data() + text.size())
      fail(fmt::format("found '{}', expected the index of a '{}'", text, statement));
    const long long size = static_cast<long long>(count);
    const long long resolved = index < 0 ? size + index : index - 1;
    if (resolved < 0 || resolved >= size)
      fail(fmt::format("found index {} of a '{}', but {} precede it", index, statement, count));
    return static_cast<std::size_t>(resolved);
  }

  Corner read_corner(std::string_view text) const {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find('/', begin), text.size());
      parts.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    if (parts.size() > 3) fail(fmt::format("found '{}', expected v/vt or v/vt/vn", text));
    Corner corner;
    corner.position = read_index(parts[0], positions_.size(), "v");
    if (parts.size() < 2 || parts[1].empty())
      fail(fmt::format("found '{}' without a texture coordinate, expected v/vt or v/vt/vn", text));
    corner.uv = read_index(parts[1], uvs_.size(), "vt");
    if (parts.size() == 3) corner.normal = read_index(parts[2], normals_.size(), "vn");
    return corner;
  }

  void read_face(const std::vector<std::string_view>& word) {
    std::vector<Corner> corners;
    for (std::size_t i = 1; i < word.size(); ++i) corners.push_back(read_corner(word[i]));
    if (corners.size() < 3)
      fail(fmt::format("found a face of {} corners, expected at least 3", corners.size()));

    const Vector3 area = area_vector(corners);
    if (!(area.norm() > 0)) return;  // nothing can hit it
    const Vector3 normal = area.normalized();
    check_convex(corners, normal);
    const bool mirrored = uv_area(corners) < 0;
    for (std::size_t i = 2; i < corners.size(); ++i)
      mesh_.triangles.push_back({vertex(corners[0], normal, mirrored),
                                 vertex(corners[i - 1], normal, mirrored),
                                 vertex(corners[i], normal, mirrored)});
    mesh_.part_of_triangle.resize(mesh_.triangles.size(), part());
  }

  /// Newell's: twice the area, along the normal.
  Vector3 area_vector(const std::vector<Corner>& corners) const {
    Vector3 sum = Vector3::Zero();
    const Vector3& origin = positions_[corners[0].position];
    for (std::size_t i = 2; i < corners.size(); ++i)
      sum += (positions_[corners[i - 1].position] - origin).cross(positions_[corners[i].position] - origin);
    return sum;
  }

  double uv_area(const std::vector<Corner>& corners) const {
    double sum = 0;
    const Vector2& origin = uvs_[corners[0].uv];
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const Vector2 a = uvs_[corners[i - 1].uv] - origin, b = uvs_[corners[i].uv] - origin;
      sum += a.x() * b.y() - a.y() * b.x();
    }
    return sum;
  }

  void check_convex(const std::vector<Corner>& corners, const Vector3& normal) const {
    const std::size_t count = corners.size();
    for (std::size_t i = 0; count > 3 && i < count; ++i) {
      const Vector3& here = positions_[corners[i].position];
      const Vector3 in = here - positions_[corners[(i + count - 1) % count].position];
      const Vector3 out = positions_[corners[(i + 1) % count].position] - here;
      if (in.cross(out).dot(normal) < -1e-6 * in.norm() * out.norm())
        fail("found a polygon that is not convex, expected convex ones: triangulate it when exporting");
    }
  }

  /// Corners that agree in everything share a vertex; mirrored faces do not, since their tangents are
  /// opposed.
  std::uint32_t vertex(const Corner& corner, const Vector3& face_normal, bool mirrored) {
    // A face's own normal is known by the line that the face stands in.
    const auto normal =
        corner.normal ? static_cast<long long>(*corner.normal) : -static_cast<long long>(line_);
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto [found, inserted] =
        vertices_.try_emplace({corner.position, corner.uv, normal, mirrored}, next);
    if (!inserted) return found->second;
    const Vector3 n = corner.normal ? normals_[*corner.normal].stableNormalized() : face_normal;
    mesh_.positions.push_back(positions_[corner.position].cast<float>());
    mesh_.uvs.push_back(uvs_[corner.uv]);
    mesh_.normals.push_back((n.norm() > 0 ? n : face_normal).cast<float>());
    return next;
  }

  std::string path_;
  std::size_t line_ = 0;
  std::string material_;  ///< that `usemtl` named last
  std::vector<Vector3> positions_, normals_;
  std::vector<Vector2> uvs_;
  std::map<std::tuple<std::size_t, std::size_t, long long, bool>, std::uint32_t> vertices_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh load_obj(const std::string& path) {
  return ObjReader(path).read();
}

}  // namespace mica::host
