#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/image/channel_file.h"

namespace mica::host {

/// A float32 EXR that is written from the top, some rows at a time, and appears whole or not at all.
class ExrRows {
 public:
  /// @param window size, place and compression; one that loses something becomes "zip".
  /// @param channels in this order. @param later attributes that `finish` is going to give, and the most
  /// letters of each. Throws FileError, as all that follows.
  ExrRows(const std::string& path, const FileWindow& window, const std::vector<std::string>& channels,
          const std::map<std::string, std::string>& metadata,
          const std::map<std::string, std::size_t>& later = {});
  ~ExrRows();

  /// @param pixels interleaved, whole rows.
  void append(const std::vector<float>& pixels);
  /// @param given values of the attributes that were to come; longer ones are cut.
  void finish(const std::map<std::string, std::string>& given = {});

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

}  // namespace mica::host
