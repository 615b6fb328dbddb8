#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "host/surface/surface.h"
#include "mica/error.h"

/// Small image files for the tests, written through OpenImageIO or byte by byte.
namespace mica::host::test {

/// A folder of its own for each test, removed with it.
class MapImages : public ::testing::Test {
 protected:
  MapImages() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / ("mica-surface-" + std::to_string(getpid()) + "-" +
                                                        test->test_suite_name() + "-" + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~MapImages() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Writes interleaved pixels, the top row first, and returns the path. T decides the pixels' type.
  template <typename T>
  std::string write(const std::string& name, int width, int height, int channels,
                    const std::vector<T>& pixels,
                    const std::function<void(OIIO::ImageSpec&)>& change = {}) const {
    OIIO::ImageSpec spec(width, height, channels, OIIO::BaseTypeFromC<T>::value);
    if (change) change(spec);
    auto output = OIIO::ImageOutput::create(name);
    EXPECT_TRUE(output && output->open(path(name), spec)) << OIIO::geterror();
    EXPECT_TRUE(output->write_image(OIIO::BaseTypeFromC<T>::value, pixels.data())) << output->geterror();
    output->close();
    return path(name);
  }

  std::string write_bytes(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  static std::string read_bytes(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  }

 private:
  std::filesystem::path folder_;
};

inline MapFile map_file(const std::string& path) {
  MapFile file;
  file.path = path;
  return file;
}

inline MapFile map_file(const std::string& path, Encoding encoding) {
  MapFile file = map_file(path);
  file.encoding_given = true;
  file.encoding = encoding;
  return file;
}

inline Surface load(const MapFile& file, SurfaceReport* report = nullptr) {
  SurfaceDescription description;
  description.source = file;
  return make_surface(description, report);
}

/// The message of the error that `action` throws; fails when it throws none of this type.
template <typename ErrorType>
std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const ErrorType& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error, or one of another type";
  return "";
}

/// Whether any line of a report holds `words`.
inline bool mentions(const std::vector<std::string>& lines, const std::string& words) {
  for (const std::string& line : lines) {
    if (line.find(words) != std::string::npos) return true;
  }
  return false;
}

}  // namespace mica::host::test
