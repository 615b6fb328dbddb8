#pragma once

#include <stdexcept>
#include <string>

#include "mica/version.h"

MICA_BEGIN_NAMESPACE

enum class ErrorKind {
  usage,     ///< what was asked for is wrong: a job, a setting, a query
  device,    ///< an OpenCL device is missing or failed
  file,      ///< a file cannot be read, is damaged or cannot be written
  cancelled  ///< the caller's CancellationToken said so
};

/// What every part of Mica throws. The message says where, what was found and what was expected.
class MICA_API Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// A call, the command line, a job or a query table is wrong.
class MICA_API UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ErrorKind::usage, message) {}
};

/// An OpenCL device is missing or failed. The message names the call and the error in words.
class MICA_API DeviceError : public Error {
 public:
  explicit DeviceError(const std::string& message) : Error(ErrorKind::device, message) {}
};

/// A file cannot be read, is damaged or cannot be written. The message begins with its path.
class MICA_API FileError : public Error {
 public:
  explicit FileError(const std::string& message) : Error(ErrorKind::file, message) {}
};

/// Work that its caller cancelled. Nothing was written.
class MICA_API Cancelled : public Error {
 public:
  Cancelled() : Error(ErrorKind::cancelled, "cancelled") {}
};

MICA_END_NAMESPACE
