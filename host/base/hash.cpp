#include "host/base/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cerrno>
#include <fstream>
#include <new>
#include <system_error>
#include <vector>

#include "mica/error.h"

namespace mica::host {

Hash::Hash() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_);
}

Hash::~Hash() {
  XXH3_freeState(state_);
}

void Hash::add(const void* bytes, std::size_t count) {
  XXH3_128bits_update(state_, bytes, count);
}

std::string Hash::digits() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string hash_of_bytes(const void* bytes, std::size_t count) {
  Hash hash;
  hash.add(bytes, count);
  return hash.digits();
}

std::string hash_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Hash hash;
  std::vector<char> block(1 << 20);
  do {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add(block.data(), static_cast<std::size_t>(file.gcount()));
  } while (file);
  if (!file.eof()) throw FileError(path + ": cannot be read: " + std::generic_category().message(errno));
  return hash.digits();
}

}  // namespace mica::host
