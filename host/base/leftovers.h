#pragma once

#include <string>

namespace mica::host {

/// A file or an empty folder that is there only while work goes on: removed when this goes, and when the
/// process is stopped before that.
class Leftover {
 public:
  explicit Leftover(std::string path);
  ~Leftover();
  Leftover(const Leftover&) = delete;
  Leftover& operator=(const Leftover&) = delete;

  /// It became something that stays.
  void keep();

 private:
  std::string path_;  // empty: kept
};

/// For a process that ends without unwinding.
void remove_leftovers() noexcept;

/// The machine's name, 64 letters at most; "host" where it has none.
std::string host_name();

/// The name for a temporary file in the folder of `target`: of this host and process, and `number`.
std::string temporary_name(const std::string& target, int number);

/// Removes temporary files that a process of this host left in `folder` and is no more.
void remove_stale_temporaries(const std::string& folder) noexcept;

}  // namespace mica::host
