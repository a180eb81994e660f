// Forward declaration of the JSON value, and the fields of structs that are stored as JSON;
// base/json.h has the functions of both.
#pragma once

#include <limits>

#include <nlohmann/detail/macro_scope.hpp>
#include <nlohmann/json_fwd.hpp>

namespace vpr {

/// Keys keep the order in which they were inserted.
using Json = nlohmann::ordered_json;

/// Defines visit_fields (see base/json.h) for a struct whose keys are the names of its members, at
/// most 63: VPR_FIELDS(WalkStop, (at_m, "Position, in m."), (seconds, "Duration.", at_least(0))).
#define VPR_FIELDS(Struct, ...)                                       \
  template <class Visitor>                                            \
  void visit_fields(Struct& value, Visitor&& visit) {                 \
    NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(VPR_FIELD, __VA_ARGS__)) \
  }
/// As VPR_FIELDS, for the content of a file of a kind: the key "schema" comes first.
#define VPR_FILE(Struct, kind, ...)                                   \
  template <class Visitor>                                            \
  void visit_fields(Struct& value, Visitor&& visit) {                 \
    visit("schema", Derived{schema_name(kind)});                      \
    NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(VPR_FIELD, __VA_ARGS__)) \
  }
#define VPR_FIELD(field) VPR_VISIT field
#define VPR_VISIT(name, ...) visit(#name, value.name __VA_OPT__(, ) __VA_ARGS__);

// Further arguments of a field, after its description, for its schema.

/// The range of all numbers in the field.
struct Bounds {
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
  bool is_open = false;  ///< `least` is out of range
};
constexpr Bounds at_least(double least) { return {.least = least}; }
constexpr Bounds above(double least) { return {.least = least, .is_open = true}; }
constexpr Bounds within(double least, double most) { return {.least = least, .most = most}; }

/// A regular expression of all strings in the field.
struct Matches {
  const char* regex;
};
inline constexpr Matches kIsChecksum = {"^xxh3:[0-9a-f]{32}$"};

/// The type of a field with its own functions: one of these.
template <class... T>
struct As {};
template <class... T>
inline constexpr As<T...> kAs;
/// Settings with all keys, as in our own files.
template <class T>
struct InForce {};

/// In files whose keys are required otherwise.
struct MayBeMissing {
  bool holds = true;
};
inline constexpr MayBeMissing kMayBeMissing;
/// In files whose keys may be missing otherwise.
struct Required {};
inline constexpr Required kRequired;
struct OrNull {};
inline constexpr OrNull kOrNull;

}  // namespace vpr
