#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

#include "mica/version.h"

MICA_BEGIN_NAMESPACE

/// A stretch of the caller's memory.
template <typename T>
struct Span {
  Span() = default;
  Span(T* first, std::size_t count) : data(first), size(count) {}
  template <typename U, typename = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
  Span(std::vector<U>& values)
      : data(values.data()), size(values.size()) {}  // NOLINT(google-explicit-constructor)
  template <typename U, typename = std::enable_if_t<std::is_convertible_v<const U (*)[], T (*)[]>>>
  Span(const std::vector<U>& values)  // NOLINT(google-explicit-constructor)
      : data(values.data()), size(values.size()) {}

  T& operator[](std::size_t n) const { return data[n]; }

  T* data = nullptr;
  std::size_t size = 0;
};

MICA_END_NAMESPACE
