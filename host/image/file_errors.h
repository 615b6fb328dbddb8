#pragma once

#include <algorithm>
#include <exception>
#include <new>
#include <string>

#include "mica/error.h"

namespace mica::host {

/// What a library said, on one line.
inline std::string reason(std::string message) {
  while (!message.empty() && (message.back() == '\n' || message.back() == ' ')) message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message.empty() ? "the file is damaged or truncated" : message;
}

/// Errors of the libraries that read a file become ours.
template <class Function>
auto with_file_errors(const std::string& path, const Function& function) {
  try {
    return function();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {  // not the file's fault
    throw;
  } catch (const std::exception& error) {
    throw FileError(path + ": cannot read: " + reason(error.what()));
  }
}

}  // namespace mica::host
