// Headers and library are of one version, and errors keep their kind across the library's border.
#include <cstdio>
#include <string>

#include "mica/error.h"
#include "mica/version.h"

int main() {
  const std::string headers = std::to_string(MICA_VERSION_MAJOR) + "." + std::to_string(MICA_VERSION_MINOR) +
                              "." + std::to_string(MICA_VERSION_PATCH);
  if (headers != mica::version()) {
    std::fprintf(stderr, "found a library of version %s, expected %s\n", mica::version(), headers.c_str());
    return 1;
  }
  try {
    throw mica::FileError("a.exr: is missing");
  } catch (const mica::Error& error) {
    return error.kind() == mica::ErrorKind::file ? 0 : 1;
  }
}
