#include "host/app/eval_output.h"

#include <fmt/format.h>

#include "host/app/evaluation.h"
#include "host/base/hash.h"
#include "mica/version.h"

namespace mica::host::app {

std::string EvalOutput::file() const {
  check_extension(path, {".npy"});
  if (shard.empty()) return path;
  const Shard part = parse_shard(shard);
  return fmt::format("{}.part-{:0{}}-of-{}", path, part.number, fmt::formatted_size("{}", part.of), part.of);
}

TableRange EvalOutput::rows(std::size_t all) const {
  const Shard part = parse_shard(shard);
  return {part.first(all), part.end(all)};
}

ValueFile EvalOutput::open(std::size_t all, std::size_t columns,
                           const std::map<std::string, std::string>& identity) const {
  if (shard.empty()) return ValueFile(file(), all, columns);
  const Shard part = parse_shard(shard);
  const TableRange range = rows(all);
  return ValueFile(file(), {part.number, part.of, range.first, range.count(), all, columns, identity});
}

void add_eval_output(CommandLine* command, EvalOutput* output) {
  command->add_option("-o,--output", output->path, "Densities, .npy").required().type_name("FILE");
  command
      ->add_option("--shard", output->shard,
                   "Evaluate part K of N of the rows, into FILE.npy.part-K-of-N; see `mica join`")
      .type_name("K/N");
}

std::map<std::string, std::string> answers_identity(const RowSource& queries, const MapOptions& map,
                                                    const MethodOptions& method,
                                                    const std::string& settings_text) {
  std::string settings = settings_text;
  for (const auto& [key, text] : method.texts) settings += fmt::format(" --{} {}", key, text);
  if (method.tolerance) settings += fmt::format(" --tolerance {}", *method.tolerance);
  std::map<std::string, std::string> identity = {{"version", version()},
                                                 {"queries", fingerprint(queries)},
                                                 {"method", method.name},
                                                 {"settings", settings}};
  if (map.path.empty()) return identity;
  identity["map"] = hash_of_file(map.path);
  identity["map options"] = fmt::format(
      "encoding {} green {} interpolation {} invalid {} part {} channels {} height scale {} precision {}",
      map.encoding, map.green, map.interpolation, map.invalid, map.part, map.channels, map.height_scale,
      map.precision);
  return identity;
}

}  // namespace mica::host::app
