#include "host/scene/obj.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <system_error>
#include <tuple>

#include "host/base/printable.h"
#include "host/scene/obj_lines.h"
#include "host/scene/polygon.h"
#include "mica/error.h"

namespace mica::host {
namespace {

using Vector3 = Eigen::Vector3d;
using Vector2 = Eigen::Vector2d;

/// One corner of a face: zero-based indices, which may be of elements that follow it; a normal of -1 is none.
struct Corner {
  long long position, uv, normal;
};

struct Face {
  std::size_t line, first_corner, corner_count;
  std::uint32_t part;
};

/// Statements that say nothing of polygons.
constexpr std::string_view kPassedOver[] = {
    "g",  "o",      "s",      "l",  "p",          "mtllib",    "lod",   "bevel", "c_interp", "d_interp",
    "mg", "usemap", "maplib", "vp", "shadow_obj", "trace_obj", "ctech", "stech", "call",     "csh"};

class ObjReader {
 public:
  explicit ObjReader(const std::string& path) : path_(path) {}

  TriangleMesh read() {
    ObjLines lines(path_);
    for (std::string line; lines.next(&line);) {
      line_ = lines.number();
      read_statement(line);
    }
    if (faces_.empty()) throw FileError(fmt::format("{}: holds no faces", path_));
    set_origin();
    for (const Face& face : faces_) add_face(face);
    if (mesh_.triangles.empty()) throw FileError(fmt::format("{}: holds no faces", path_));
    if (mesh_.parts.size() == 1) mesh_.part_of_triangle.clear();
    set_tangents(&mesh_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw FileError(fmt::format("{}:{}: {}", path_, line_, message));
  }

  /// A comment begins a word: materials may be named Mat#1.
  static std::vector<std::string_view> words(std::string_view line) {
    constexpr std::string_view blanks = " \t";
    std::vector<std::string_view> found;
    for (std::size_t begin = 0; (begin = line.find_first_not_of(blanks, begin)) != line.npos;) {
      if (line[begin] == '#') break;
      const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
      found.push_back(line.substr(begin, end - begin));
      begin = end;
    }
    return found;
  }

  void read_statement(std::string_view line) {
    const std::vector<std::string_view> word = words(line);
    if (word.empty()) return;
    if (word[0] == "v")
      positions_.push_back(read_vector<3>(word, 3));
    else if (word[0] == "vt")
      uvs_.push_back(read_vector<2>(word, 1));
    else if (word[0] == "vn")
      normals_.push_back(read_vector<3>(word, 3));
    else if (word[0] == "f")
      read_face(word);
    else if (word[0] == "usemtl")
      use_material(word);
    else if (std::find(std::begin(kPassedOver), std::end(kPassedOver), word[0]) == std::end(kPassedOver))
      refuse_statement(word[0]);
  }

  /// Of a file that is no OBJ file nothing is repeated: a job may name any.
  [[noreturn]] void refuse_statement(std::string_view word) const {
    if (positions_.empty() && uvs_.empty() && normals_.empty())
      fail("found no statement of a Wavefront OBJ file, expected v, vt, vn or f");
    fail(fmt::format("found the statement '{}', expected v, vt, vn or f", shortened(word)));
  }

  /// Names may have blanks between; none is no material.
  void use_material(const std::vector<std::string_view>& word) {
    material_.clear();
    if (word.size() == 1) return;
    const char* const begin = word[1].data();
    material_.assign(begin, word.back().data() + word.back().size());
  }

  /// Index of the part that faces now belong to.
  std::uint32_t part() {
    const auto found = std::find(mesh_.parts.begin(), mesh_.parts.end(), material_);
    const auto index = static_cast<std::uint32_t>(found - mesh_.parts.begin());
    if (found == mesh_.parts.end()) mesh_.parts.push_back(material_);
    return index;
  }

  /// The first `size` numbers, of which `required` have to be there; OBJ allows more (weights, colours),
  /// which say nothing here.
  template <int size>
  Eigen::Matrix<double, size, 1> read_vector(const std::vector<std::string_view>& word, int required) const {
    const int count = static_cast<int>(word.size()) - 1;
    if (count < required) fail(fmt::format("found {} numbers after '{}', expected {}", count, word[0], size));
    Eigen::Matrix<double, size, 1> vector = Eigen::Matrix<double, size, 1>::Zero();
    for (int i = 0; i < std::min(size, count); ++i)
      vector[i] = read_number(word[static_cast<std::size_t>(i) + 1]);
    return vector;
  }

  double read_number(std::string_view text) const {
    constexpr double limit = 1e15;  // far below the coordinates at which single precision overflows
    std::string_view digits = text;
    if (digits.size() > 1 && digits.front() == '+') digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
      fail(fmt::format("found '{}', expected a number", shortened(text)));
    if (error == std::errc::result_out_of_range)
      value = std::strtod(std::string(digits).c_str(), nullptr);  // next to 0, or infinite
    if (!(std::abs(value) <= limit))
      fail(fmt::format("found {}, expected a number between -1e15 and 1e15", shortened(text)));
    return value;
  }

  /// One-based, or counted back from the latest element when negative.
  long long read_index(std::string_view text, std::size_t count, const char* statement) const {
    long long index = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (error != std::errc() || end != text.data() + text.size())
      fail(fmt::format("found '{}', expected the index of a '{}'", shortened(text), statement));
    const long long resolved = index < 0 ? static_cast<long long>(count) + index : index - 1;
    if (resolved < 0)
      fail(fmt::format("found index {} of a '{}', but {} precede it", index, statement, count));
    return resolved;
  }

  Corner read_corner(std::string_view text) const {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find('/', begin), text.size());
      parts.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    if (parts.size() > 3) fail(fmt::format("found '{}', expected v/vt or v/vt/vn", shortened(text)));
    Corner corner{};
    corner.position = read_index(parts[0], positions_.size(), "v");
    if (parts.size() < 2 || parts[1].empty())
      fail(fmt::format("found '{}' without a texture coordinate, expected v/vt or v/vt/vn", shortened(text)));
    corner.uv = read_index(parts[1], uvs_.size(), "vt");
    const bool has_normal = parts.size() == 3 && !parts[2].empty();
    corner.normal = has_normal ? read_index(parts[2], normals_.size(), "vn") : -1;
    return corner;
  }

  void read_face(const std::vector<std::string_view>& word) {
    const std::size_t first = corners_.size(), count = word.size() - 1;
    for (std::size_t i = 1; i < word.size(); ++i) corners_.push_back(read_corner(word[i]));
    if (count < 2) fail(fmt::format("found a face of {} corners, expected at least 3", count));
    faces_.push_back({line_, first, count, part()});  // two corners are a loose edge
  }

  void check_index(long long index, std::size_t count, const char* statement) const {
    if (index >= static_cast<long long>(count))
      fail(fmt::format("found index {} of a '{}', but there are {}", index + 1, statement, count));
  }

  /// Far away single precision has no room for what a mesh is made of: its vertices are kept relative to its
  /// middle.
  void set_origin() {
    Eigen::AlignedBox3d box;
    for (const Vector3& position : positions_) box.extend(position);
    if (box.isEmpty()) return;
    if (box.center().cwiseAbs().maxCoeff() > 2 * box.sizes().maxCoeff()) mesh_.origin = box.center();
  }

  void add_face(const Face& face) {
    line_ = face.line;
    const Corner* corners = &corners_[face.first_corner];
    std::vector<Vector3> positions;
    for (std::size_t n = 0; n < face.corner_count; ++n) {
      check_index(corners[n].position, positions_.size(), "v");
      check_index(corners[n].uv, uvs_.size(), "vt");
      check_index(corners[n].normal, normals_.size(), "vn");
      positions.push_back(positions_[static_cast<std::size_t>(corners[n].position)]);
    }
    const Vector3 area = polygon_area(positions);
    if (!(area.norm() > 0)) return;  // nothing can hit it
    const std::vector<std::array<std::size_t, 3>> triangles = triangulate(positions);
    if (triangles.empty())
      fail(fmt::format(
          "found a polygon of {} corners that crosses itself, expected one that does not: triangulate "
          "it when exporting",
          face.corner_count));
    const bool mirrored = uv_area(corners, face.corner_count) < 0;
    for (const std::array<std::size_t, 3>& triangle : triangles) {
      std::array<std::uint32_t, 3> vertices{};
      for (std::size_t n = 0; n < 3; ++n)
        vertices[n] = vertex(corners[triangle[n]], area.normalized(), mirrored);
      mesh_.triangles.push_back(vertices);
    }
    mesh_.part_of_triangle.resize(mesh_.triangles.size(), face.part);
  }

  double uv_area(const Corner* corners, std::size_t count) const {
    const auto uv = [&](std::size_t n) { return uvs_[static_cast<std::size_t>(corners[n].uv)]; };
    double sum = 0;
    for (std::size_t n = 2; n < count; ++n) {
      const Vector2 a = uv(n - 1) - uv(0), b = uv(n) - uv(0);
      sum += a.x() * b.y() - a.y() * b.x();
    }
    return sum;
  }

  /// Corners that agree in everything share a vertex; mirrored faces do not, since their tangents are
  /// opposed.
  std::uint32_t vertex(const Corner& corner, const Vector3& face_normal, bool mirrored) {
    // A face's own normal is known by the line that the face stands in.
    const long long normal = corner.normal >= 0 ? corner.normal : -static_cast<long long>(line_);
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto [found, inserted] =
        vertices_.try_emplace({corner.position, corner.uv, normal, mirrored}, next);
    if (!inserted) return found->second;
    const Vector3 n = corner.normal >= 0
                          ? normals_[static_cast<std::size_t>(corner.normal)].stableNormalized()
                          : face_normal;
    mesh_.positions.push_back(
        (positions_[static_cast<std::size_t>(corner.position)] - mesh_.origin).cast<float>());
    mesh_.uvs.push_back(uvs_[static_cast<std::size_t>(corner.uv)]);
    mesh_.normals.push_back((n.norm() > 0 ? n : face_normal).cast<float>());
    return next;
  }

  std::string path_;
  std::size_t line_ = 0;
  std::string material_;  ///< that `usemtl` named last
  std::vector<Vector3> positions_, normals_;
  std::vector<Vector2> uvs_;
  std::vector<Corner> corners_;
  std::vector<Face> faces_;
  std::map<std::tuple<long long, long long, long long, bool>, std::uint32_t> vertices_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh load_obj(const std::string& path) {
  return ObjReader(path).read();
}

}  // namespace mica::host
