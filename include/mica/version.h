#pragma once

// Mica follows semantic versions. All public names are in an inline namespace that carries the part of the
// version that breaks them, so that code built against another one does not link instead of misbehaving.
#define MICA_VERSION_MAJOR 0
#define MICA_VERSION_MINOR 2
#define MICA_VERSION_PATCH 0

#define MICA_BEGIN_NAMESPACE \
  namespace mica {           \
  inline namespace v0_2 {
#define MICA_END_NAMESPACE \
  }                        \
  }

#if defined(MICA_SHARED) && defined(__GNUC__)
#define MICA_API __attribute__((visibility("default")))
#else
#define MICA_API
#endif

MICA_BEGIN_NAMESPACE

/// Of the library that runs: "0.2.0".
MICA_API const char* version();

MICA_END_NAMESPACE
