#pragma once

#include <string>
#include <vector>

#include "host/report/sequence_page.h"

namespace mica::host::app {

/// What a folder's pictures and logs (`*.jsonl`, also in folders below it) say of the sequences in it. A
/// frame is done when its files are whole and of the job that rendered last; running when the process that
/// has it lives: on this machine by its number, elsewhere by a log that is less than a minute old.
/// @param thumbnails whether frames get theirs.
/// Throws FileError when it is no folder.
std::vector<SequenceStatus> read_ledger(const std::string& folder, bool thumbnails);

}  // namespace mica::host::app
