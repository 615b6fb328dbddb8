// Attributes of OpenEXR headers by which its library would take memory that the file has no bytes for.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "host/image/image.h"
#include "mica/error.h"
#include "tests/image/folder.h"

namespace mica::host::exr_attributes_test {
namespace {

using ExrAttributes = FolderTest;

std::string little_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift));
  return bytes;
}

std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
  return name + '\0' + type + '\0' + little_endian(static_cast<std::uint32_t>(value.size())) + value;
}

/// What reading says of a file whose header begins with one attribute.
std::string said_of(const std::string& path, const std::string& first) {
  std::ofstream(path, std::ios::binary)
      << "\x76\x2f\x31\x01" << little_endian(2) << first
      << attribute("compression", "compression", std::string(1, '\0')) << '\0';
  try {
    read_rgb(path);
  } catch (const FileError& error) {
    return error.what();
  }
  return "nothing";
}

TEST_F(ExrAttributes, OfASizeThatTheirTypeHasNotAreDamage) {
  for (const std::string& broken :
       {attribute("displayWindow", "box2i", ""), attribute("pixelAspectRatio", "float", std::string(8, '\0')),
        attribute("preview", "preview", little_endian(20000) + little_endian(20000)),
        attribute("preview", "preview", little_endian(1u << 31) + little_endian(2)),
        attribute("views", "stringvector", little_endian(1u << 30) + "left"),
        attribute("views", "stringvector", little_endian(~0u) + "left"),
        attribute("mine", "chlist", std::string("B\0", 2) + std::string(16, '\0')),
        attribute("mine", "chlist", std::string(3, '\0'))})
    EXPECT_NE(said_of(path("a.exr"), broken).find("header is damaged"), std::string::npos)
        << broken << ": " << said_of(path("a.exr"), broken);
}

TEST_F(ExrAttributes, OfTheirOwnSizeAreNot) {
  for (const std::string& whole :
       {attribute("displayWindow", "box2i", std::string(16, '\0')),
        attribute("preview", "preview", little_endian(1) + little_endian(1) + "rgba"),
        attribute("views", "stringvector", little_endian(4) + "left" + little_endian(5) + "right"),
        attribute("mine", "chlist", std::string("B\0", 2) + std::string(17, '\0')),
        attribute("mine", "my own type", "anything")})
    EXPECT_EQ(said_of(path("a.exr"), whole).find("header is damaged"), std::string::npos)
        << whole << ": " << said_of(path("a.exr"), whole);
}

}  // namespace
}  // namespace mica::host::exr_attributes_test
