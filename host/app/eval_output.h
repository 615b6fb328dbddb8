#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "host/app/command_line.h"
#include "host/app/map_options.h"
#include "host/app/method_options.h"
#include "host/app/shard.h"
#include "host/tables/query_table.h"
#include "host/tables/value_file.h"

namespace mica::host::app {

/// Where `mica eval` writes: a NumPy file, or with `--shard` a part of one.
struct EvalOutput {
  std::string path, shard;

  /// "D.npy", or "D.npy.part-3-of-8". Throws UsageError for another ending and for what is no shard.
  std::string file() const;
  /// The rows that are evaluated, of `all`.
  TableRange rows(std::size_t all) const;
  /// @param columns of the answers; 0: one number a row. @param identity as TablePart's.
  ValueFile open(std::size_t all, std::size_t columns,
                 const std::map<std::string, std::string>& identity) const;
};

void add_eval_output(CommandLine* command, EvalOutput* output);

/// What answers depend on, by name: the queries, the map, the method with its settings.
/// @param settings_text other options that count, as they were given.
std::map<std::string, std::string> answers_identity(const RowSource& queries, const MapOptions& map,
                                                    const MethodOptions& method,
                                                    const std::string& settings_text);

}  // namespace mica::host::app
