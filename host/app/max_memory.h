#pragma once

#include <cstdint>

#include "host/app/command_line.h"

namespace mica::host::app {

/// `--max-memory`.
struct MaxMemory {
  int mebibytes = 0;

  std::uint64_t bytes() const { return static_cast<std::uint64_t>(mebibytes) << 20; }
};

inline void add_max_memory(CommandLine* command, MaxMemory* memory) {
  command
      ->add_option("--max-memory", memory->mebibytes,
                   "Most memory that reading an image file may take; default half of the machine's")
      .type_name("MIB")
      .check(between(1, 1 << 24));
}

}  // namespace mica::host::app
