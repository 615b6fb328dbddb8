#pragma once

#include <stdexcept>
#include <string>

namespace mica {

/// Exit codes of the command line; part of its contract.
enum class ExitCode { done = 0, some_images_failed = 1, usage = 2, device = 3, file = 4 };

/// What every part of Mica throws; `main` prints the message and exits with the code.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// The command line, a job or a query table is wrong. The message says where, what was found and what was
/// expected.
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

/// An OpenCL device is missing or failed. The message names the call and the error in words.
class DeviceError : public Error {
 public:
  explicit DeviceError(const std::string& message) : Error(ExitCode::device, message) {}
};

/// A file cannot be read, is damaged or cannot be written. The message begins with its path.
class FileError : public Error {
 public:
  explicit FileError(const std::string& message) : Error(ExitCode::file, message) {}
};

}  // namespace mica
