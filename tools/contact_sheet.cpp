// Puts images of one size beside and below each other:
//   contact_sheet COLUMNS GAP_PIXELS OUTPUT.png IMAGE.png...
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.size() < 4) {
    std::cerr << "usage: contact_sheet COLUMNS GAP_PIXELS OUTPUT.png IMAGE.png...\n";
    return 2;
  }
  const int columns = std::atoi(words[0].c_str()), gap = std::atoi(words[1].c_str());
  const std::vector<std::string> files(words.begin() + 3, words.end());
  if (columns < 1 || gap < 0) return 2;

  OIIO::ImageBuf sheet;
  for (std::size_t n = 0; n < files.size(); ++n) {
    const OIIO::ImageBuf image(files[n]);
    const OIIO::ImageSpec& spec = image.spec();
    if (n == 0) {
      const int rows = (static_cast<int>(files.size()) + columns - 1) / columns;
      sheet.reset(OIIO::ImageSpec(columns * (spec.width + gap) - gap, rows * (spec.height + gap) - gap,
                                  spec.nchannels, OIIO::TypeDesc::UINT8));
      OIIO::ImageBufAlgo::fill(sheet, std::vector<float>(static_cast<std::size_t>(spec.nchannels), 1.0f));
    }
    const int place = static_cast<int>(n);
    if (!OIIO::ImageBufAlgo::paste(sheet, place % columns * (spec.width + gap),
                                   place / columns * (spec.height + gap), 0, 0, image)) {
      std::cerr << files[n] << ": " << sheet.geterror() << "\n";
      return 4;
    }
  }
  if (sheet.write(words[2])) return 0;
  std::cerr << words[2] << ": " << sheet.geterror() << "\n";
  return 4;
}
