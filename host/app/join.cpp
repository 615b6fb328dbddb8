// mica join: one picture from its parts.
#include <fmt/format.h>

#include <filesystem>

#include "host/app/commands.h"
#include "host/app/output.h"
#include "host/app/picture_names.h"
#include "host/app/say.h"
#include "host/base/interrupt.h"
#include "host/image/stored_picture.h"
#include "host/render/part.h"
#include "host/tables/value_file.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

struct JoinOptions {
  std::vector<std::string> parts;
  std::string output;
  bool quiet = false;
};

/// Throws FileError naming every part that cannot be read.
std::vector<PicturePart> read_parts(const std::vector<std::string>& paths) {
  std::vector<PicturePart> parts;
  std::string problems;
  for (const std::string& path : paths) {
    check_interrupt();
    try {
      parts.push_back({path, read_stored_picture(path)});
    } catch (const FileError& error) {
      problems += fmt::format("{}{}", problems.empty() ? "" : "\n  ", error.what());
    }
  }
  if (!problems.empty()) throw FileError("cannot join: " + problems);
  return parts;
}

int join_table(const JoinOptions& options) {
  const Outputs outputs({options.output}, options.parts);
  const std::uint64_t rows = join_tables(options.parts, options.output);
  if (!options.quiet)
    say("wrote     {}, {} rows, from {} parts\n", options.output, rows, options.parts.size());
  return 0;
}

int run(const JoinOptions& options) {
  if (std::filesystem::path(options.output).extension() == ".npy") return join_table(options);
  const PictureNames names = picture_names("", options.output);
  const Outputs outputs({names.exr, names.png}, options.parts);
  const JoinedPicture joined = join(read_parts(options.parts));
  check_interrupt();
  if (!names.exr.empty()) write_exr(names.exr, joined.image);
  write_png(names.png, joined.image, joined.exposure, joined.tone_map);
  if (options.quiet) return 0;
  if (const auto audit = joined.image.metadata.find("mica:audit"); audit != joined.image.metadata.end())
    say("audit     {}\n", audit->second);
  say("wrote     {}{}{} from {} parts\n", names.exr, names.exr.empty() ? "" : " and ", names.png,
      options.parts.size());
  return 0;
}

}  // namespace

void add_join(CommandLine& app, Command* chosen, const MethodRegistry&) {
  auto options = std::make_shared<JoinOptions>();
  CommandLine* command = app.add_subcommand(
      "join", "Make one picture or table of its parts, as `mica render` and `mica eval --shard` write them");
  command->add_option("parts", options->parts, "All parts, in any order").required().type_name("PART");
  command
      ->add_option("-o,--output", options->output,
                   "FILE.exr (with FILE.png beside it) or FILE.png; of a table FILE.npy")
      .required()
      .type_name("FILE");
  command->add_flag("--quiet", options->quiet, "No summary");
  command->callback([=] { *chosen = [=] { return run(*options); }; });
}

}  // namespace mica::host::app
