#pragma once

#include <cstddef>
#include <string>

struct XXH3_state_s;

namespace mica::host {

/// XXH3 of 128 bits, as 32 hexadecimal digits: tells contents apart, and is no protection against those who
/// mean harm. https://xxhash.com
class Hash {
 public:
  Hash();
  ~Hash();
  Hash(const Hash&) = delete;
  Hash& operator=(const Hash&) = delete;

  void add(const void* bytes, std::size_t count);
  void add(const std::string& text) { add(text.data(), text.size()); }
  std::string digits() const;

 private:
  XXH3_state_s* state_;
};

std::string hash_of_bytes(const void* bytes, std::size_t count);

/// Of a file's contents. Throws FileError.
std::string hash_of_file(const std::string& path);

}  // namespace mica::host
