// Forward declaration of the JSON value, and the fields of structs that are stored as JSON;
// base/json.h has the functions of both.
#pragma once

#include <nlohmann/detail/macro_scope.hpp>
#include <nlohmann/json_fwd.hpp>

namespace vpr {

/// Keys keep the order in which they were inserted.
using Json = nlohmann::ordered_json;

/// Defines visit_fields (see base/json.h) for a struct whose keys are the names of its members, at
/// most 63: VPR_FIELDS(WalkStop, at_m, seconds).
#define VPR_FIELDS(Struct, ...)                                       \
  template <class Visitor>                                            \
  void visit_fields(Struct& value, Visitor&& visit) {                 \
    NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(VPR_FIELD, __VA_ARGS__)) \
  }
#define VPR_FIELD(name) visit(#name, value.name);

}  // namespace vpr
