// Jobs: the first line is what --set says (or nothing), the rest is TOML.
#include <algorithm>
#include <vector>

#include "host/job/job.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static mica::fuzz::File file(".toml");
  const std::uint8_t* const end = bytes + size;
  const std::uint8_t* const line_end = std::find(bytes, end, '\n');
  std::vector<std::string> overrides;
  if (line_end != bytes) overrides.emplace_back(bytes, line_end);
  const std::uint8_t* const text = line_end == end ? end : line_end + 1;
  const std::string& path = file.write(text, static_cast<std::size_t>(end - text));
  mica::fuzz::refusing([&] { mica::host::load_job(path, overrides); });
  return 0;
}
