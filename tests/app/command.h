#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "host/surface/export.h"
#include "host/surface/surface.h"
#include "tests/image/folder.h"

/// What the tests of the command line share: the program, run in a folder of its own, and its input files.
namespace mica::host::app {

/// Bytes of a .npy file. @param shape as Python writes a tuple, "(3, 7)".
inline std::string npy_bytes(const std::string& descr, bool fortran_order, const std::string& shape,
                             const std::string& data, int version = 1) {
  std::string header = "{'descr': '" + descr + "', 'fortran_order': " + (fortran_order ? "True" : "False") +
                       ", 'shape': " + shape + ", }";
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  while ((8 + length_bytes + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (std::size_t n = 0; n < length_bytes; ++n)
    bytes += static_cast<char>((header.size() >> (8 * n)) & 0xff);
  return bytes + header + data;
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// A query table, row by row.
using Rows = std::vector<std::vector<double>>;

template <typename T>
std::string npy_of(const Rows& rows, const std::string& descr) {
  std::vector<T> values;
  for (const std::vector<double>& row : rows)
    for (const double value : row) values.push_back(static_cast<T>(value));
  const std::string columns = rows.empty() ? "7" : std::to_string(rows[0].size());
  return npy_bytes(descr, false, "(" + std::to_string(rows.size()) + ", " + columns + ")", bytes_of(values));
}
inline std::string npy_of(const Rows& rows) {
  return npy_of<double>(rows, "<f8");
}

/// Rows u v cuu cuv cvv s t on a 32 x 32 map: footprints of 0.5 to 2 texels, half vectors near the normals.
inline Rows query_rows(int count) {
  Rows rows;
  for (int n = 0; n < count; ++n) {
    const double sigma = (0.5 + 1.5 * n / count) / 32;
    rows.push_back({0.37 * n, 0.21 * n, sigma * sigma, 0.3 * sigma * sigma, sigma * sigma, 0.1 * std::sin(n),
                    0.1 * std::cos(n)});
  }
  return rows;
}

class CommandTest : public FolderTest {
 protected:
  struct Outcome {
    int code;
    std::string out, err;
  };

  CommandTest() { log_folder_ = folder_.string() + "_log", std::filesystem::create_directories(log_folder_); }
  ~CommandTest() override { std::filesystem::remove_all(log_folder_); }

  /// Runs the program inside the test's folder. @param before what the shell puts in front of it, e.g. an
  /// environment variable.
  Outcome mica(const std::string& arguments, const std::string& before = "") const {
    const std::string out = log_folder_ + "/out", err = log_folder_ + "/err";
    const std::string command = "cd '" + folder_.string() + "' && " + before + " '" MICA_PROGRAM "' " +
                                arguments + " >'" + out + "' 2>'" + err + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, bytes(out), bytes(err)};
  }

  void write(const std::string& file, const std::string& content) const {
    std::ofstream(path(file), std::ios::binary) << content;
  }
  void write_map(const std::string& file, const Surface& surface) const {
    write_exr(path(file), {surface.width(), surface.height(), {"R", "G", "B"}, to_signed_rgb(surface), {}});
  }
  /// A small map.exr.
  void write_map() const { write_map("map.exr", spectrum()); }
  static Surface spectrum() {
    return make_surface({"bumps", SpectrumSurface{32, 0.2, 4, 1}, Interpolation::bilinear}, nullptr);
  }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      names.insert(entry.path().filename().string());
    return names;
  }

  /// The values of a .npy file of shape (n,), or (n, columns), checked against the format's own rules.
  std::vector<float> densities(const std::string& file, std::size_t columns = 0) const {
    const std::string content = bytes(path(file));
    if (content.size() < 10 || content.compare(0, 8, std::string("\x93NUMPY\x01\x00", 8)) != 0) {
      ADD_FAILURE() << file << " is no .npy file of version 1.0";
      return {};
    }
    const std::size_t header =
        static_cast<unsigned char>(content[8]) + 256u * static_cast<unsigned char>(content[9]);
    EXPECT_EQ((10 + header) % 64, 0u);
    std::vector<float> values((content.size() - 10 - header) / sizeof(float));
    if (!values.empty())  // memcpy takes no null pointer, not even for no bytes
      std::memcpy(values.data(), content.data() + 10 + header, values.size() * sizeof(float));
    const std::string sizes = columns
                                  ? std::to_string(values.size() / columns) + ", " + std::to_string(columns)
                                  : std::to_string(values.size()) + ",";
    const std::string shape = "'descr': '<f4', 'fortran_order': False, 'shape': (" + sizes + ")";
    EXPECT_NE(content.substr(10, header).find(shape), std::string::npos) << content.substr(10, header);
    return values;
  }

 private:
  std::string log_folder_;
};

}  // namespace mica::host::app
