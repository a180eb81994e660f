// Names of enumerators in files, flags and tables.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace vpr {

/// Names of the enumerators of E, in their order; specialize as `kEnumNames<E>`.
template <class E>
inline constexpr std::array<std::string_view, 0> kEnumNames{};

/// `value` must be one of the enumerators.
template <class E>
std::string_view enum_name(E value) {
  return kEnumNames<E>[static_cast<size_t>(value)];
}

/// The enumerator with this name, or nullopt.
template <class E>
std::optional<E> enum_value(std::string_view name) {
  for (size_t i = 0; i < kEnumNames<E>.size(); ++i)
    if (kEnumNames<E>[i] == name) return static_cast<E>(i);
  return std::nullopt;
}

}  // namespace vpr
