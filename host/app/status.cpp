// mica status: which frames of a folder are done, running, failed or missing.
#include <fmt/format.h>

#include "host/app/commands.h"
#include "host/app/ledger.h"
#include "host/app/output.h"
#include "host/base/printable.h"
#include "host/job/frame_list.h"

namespace mica::host::app {
namespace {

struct StatusOptions {
  std::string folder, html;
  bool remaining = false;
};

void print(const SequenceStatus& sequence) {
  std::string line = fmt::format("{}: {} frames", printable(sequence.output), sequence.frames.size());
  for (const Word<FrameState>& state : Words<FrameState>::all)
    line += fmt::format(", {} {}", sequence.count(state.value), state.word);
  fmt::print("{}\n", line);
  for (const FrameStatus& frame : sequence.frames)
    if (frame.state == FrameState::running || frame.state == FrameState::failed)
      fmt::print("  frame {} {}: {}\n", frame.frame, word_of(frame.state), printable(frame.note));
  if (const std::vector<int> rest = sequence.remaining(); !rest.empty())
    fmt::print("  remaining: --frames {}\n", frame_list(rest));
}

int run(const StatusOptions& options) {
  const Outputs outputs({options.html});
  const std::vector<SequenceStatus> sequences = read_ledger(options.folder, !options.html.empty());
  for (const SequenceStatus& sequence : sequences) {
    if (!options.remaining)
      print(sequence);
    else if (const std::vector<int> rest = sequence.remaining(); !rest.empty())
      fmt::print("{}\n", frame_list(rest));
  }
  if (sequences.empty() && !options.remaining) fmt::print("no frames and no logs\n");
  if (!options.html.empty()) write_file_atomically(options.html, sequence_page(options.folder, sequences));
  return 0;
}

}  // namespace

void add_status(CommandLine& app, Command* chosen, const MethodRegistry&) {
  auto options = std::make_shared<StatusOptions>();
  CommandLine* command =
      app.add_subcommand("status", "Tell which frames of a folder are done, running, failed or missing");
  command->add_option("folder", options->folder, "Where the frames are, with their logs, *.jsonl")
      .required()
      .type_name("DIR");
  command->add_flag("--remaining", options->remaining,
                    "Print nothing but the --frames that are neither done nor running");
  command->add_option("--html", options->html, "Write a page with a small picture of each frame")
      .type_name("FILE");
  command->callback([=] { *chosen = [=] { return run(*options); }; });
}

}  // namespace mica::host::app
