// Tables of queries, as NumPy arrays and as text: one or the other by the first bytes.
#include <cstring>

#include "host/tables/query_table.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static mica::fuzz::File array(".npy"), text(".csv");
  const bool is_array = size > 0 && bytes[0] == 0x93;
  const std::string& path = (is_array ? array : text).write(bytes, size);
  mica::fuzz::refusing([&] {
    const mica::host::QueryTable table(path, 0.1);
    for (std::size_t row = 0; row < table.size(); ++row) table.query(row);
  });
  return 0;
}
