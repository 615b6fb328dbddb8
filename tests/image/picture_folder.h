#pragma once

#include <OpenImageIO/imageio.h>

#include <string>
#include <vector>

#include "tests/image/folder.h"

namespace mica::host {

/// A folder of pictures that OpenImageIO writes.
class PictureFolderTest : public FolderTest {
 protected:
  /// @param spec its size, channels and attributes; the format is that of the values.
  template <class Value>
  std::string write(const std::string& name, OIIO::ImageSpec spec, const std::vector<Value>& values) const {
    spec.set_format(OIIO::BaseTypeFromC<Value>::value);
    auto output = OIIO::ImageOutput::create(path(name));
    EXPECT_TRUE(output && output->open(path(name), spec)) << name << OIIO::geterror();
    EXPECT_TRUE(output->write_image(spec.format, values.data())) << output->geterror();
    EXPECT_TRUE(output->close());
    return path(name);
  }
};

}  // namespace mica::host
