// Names of an enum's values, for files, flags and tables.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace vpr {

/// Names of the values of E, in their order; specialise as `kEnumNames<E>`.
template <class E>
inline constexpr std::array<std::string_view, 0> kEnumNames{};

/// The name of a value of E, which must be one of its enumerators.
template <class E>
std::string_view enum_name(E value) {
  return kEnumNames<E>[static_cast<size_t>(value)];
}

/// The value of E that has a name; nothing where none has it.
template <class E>
std::optional<E> enum_value(std::string_view name) {
  for (size_t i = 0; i < kEnumNames<E>.size(); ++i)
    if (kEnumNames<E>[i] == name) return static_cast<E>(i);
  return std::nullopt;
}

}  // namespace vpr
