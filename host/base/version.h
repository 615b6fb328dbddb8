#pragma once

namespace mica {

/// "0.1.0"
inline const char* version() {
  return MICA_VERSION;
}

}  // namespace mica
