// JSON Schemas of structs, made from the types, descriptions and bounds of their fields
// (base/json.h). Only the generator of docs/schemas uses them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/json.h"

namespace vpr {

/// The demands of a schema on all structs in a value.
enum class SchemaForm {
  data,     ///< all keys, except those that a field omits; an optional without a value is null
  partial,  ///< settings that people write: no key but those marked as required
  in_force  ///< settings in our own files: all keys, except those marked kMayBeMissing
};

/// A field as a visitor receives it, whose object has default values.
template <class Field>
Json field_schema(Field& field, SchemaForm form);

/// The schema of a type.
template <class T>
Json schema_of(SchemaForm form = SchemaForm::data) {
  T value{};
  return field_schema(value, form);
}

/// A description from the help of a flag, or a sentence as it is.
std::string sentence(std::string_view text);

/// The schema with the key "schema" at first.
Json with_kind(std::string_view kind, const Json& schema);
/// The schema of objects of both schemas: with all keys, of which those of both are required.
Json merged(Json a, const Json& b);

/// The schema of a whole file.
/// The same for objects with one of these schemas.
Json file_schema(std::string_view kind, std::string_view title, const std::vector<Json>& schemas);

namespace detail {
Json or_null(Json schema);
Json or_auto(Json schema);
Json any_of(std::vector<Json> schemas);
void add_hint(Json& schema, const Bounds& bounds);
void add_hint(Json& schema, const Matches& pattern);
void add_hint(Json& schema, OrNull);
inline void add_hint(Json&, MayBeMissing) {}
inline void add_hint(Json&, Required) {}
template <class... T>
void add_hint(Json&, As<T...>) {}
void add_property(Json& object, std::string_view key, Json schema, std::string_view text,
                  bool is_required);

inline bool may_be_missing(MayBeMissing hint) { return hint.holds; }
inline bool may_be_missing(const auto&) { return false; }

template <class T>
inline constexpr bool kIsInForce = false;
template <class T>
inline constexpr bool kIsInForce<InForce<T>> = true;
template <class T>
inline constexpr bool kIsAs = false;
template <class... T>
inline constexpr bool kIsAs<As<T...>> = true;

template <class T>
T type_in(InForce<T>);

template <class T>
Json schema_as(SchemaForm form) {
  if constexpr (kIsInForce<T>)
    return schema_of<decltype(type_in(T{}))>(SchemaForm::in_force);
  else
    return schema_of<T>(form);
}
template <class... T>
Json schema_by(As<T...>, SchemaForm form) {
  return any_of({schema_as<T>(form)...});
}
inline Json schema_by(const auto&, SchemaForm) { return {}; }

template <class T>
Json held_schema(IfSet<T>&, SchemaForm form) {
  return schema_of<T>(form);
}
template <class T>
Json held_schema(Unless<T>& field, SchemaForm form) {
  return field_schema(field.field, form);
}
template <class Test, class T>
Json held_schema(PresentIf<Test, T>& field, SchemaForm form) {
  return field_schema(field.field, form);
}
template <class T>
Json held_schema(Derived<T>& field, SchemaForm form) {
  return field_schema(field.value, form);
}
template <class T, class Visit>
Json held_schema(NestedList<T, Visit>& field, SchemaForm form) {
  T item{};
  auto object = field.object_of(item);
  return {{"type", "array"}, {"items", field_schema(object, form)}};
}

template <class Field>
inline constexpr bool kIsOmittable = false;
template <class T>
inline constexpr bool kIsOmittable<IfSet<T>> = true;
template <class T>
inline constexpr bool kIsOmittable<Unless<T>> = true;
template <class Test, class T>
inline constexpr bool kIsOmittable<PresentIf<Test, T>> = true;
}  // namespace detail

/// Collects the properties of an object, of a given schema or a new one.
struct SchemaVisitor {
  SchemaForm form;
  Json object = {{"type", "object"},
                 {"properties", Json::object()},
                 {"required", Json::array()},
                 {"additionalProperties", false}};

  template <class Field, class... Hints>
  void operator()(std::string_view key, Field&& field, std::string_view text = {},
                  const Hints&... hints) {
    using T = std::remove_cvref_t<Field>;
    Json schema;
    if constexpr ((detail::kIsAs<Hints> || ...))
      ((detail::kIsAs<Hints> ? schema = detail::schema_by(hints, form) : schema), ...);
    else
      schema = field_schema(field, form);
    (detail::add_hint(schema, hints), ...);
    const bool is_required = (std::is_same_v<Hints, Required> || ...) ||
                             (form != SchemaForm::partial && !detail::kIsOmittable<T> &&
                              !(detail::may_be_missing(hints) || ...));
    detail::add_property(object, key, std::move(schema), text, is_required);
  }
};

template <class Field>
Json field_schema(Field& field, SchemaForm form) {
  using T = std::remove_cv_t<Field>;
  if constexpr (Settings<T>) {
    SchemaVisitor visitor{form};
    visit_fields(const_cast<T&>(field), visitor);
    return visitor.object;
  } else if constexpr (requires { detail::held_schema(field, form); }) {
    return detail::held_schema(field, form);
  } else if constexpr (detail::kIsOptional<T>) {
    Json schema = schema_of<typename T::value_type>(form);
    return form == SchemaForm::data ? detail::or_null(schema) : detail::or_auto(schema);
  } else if constexpr (detail::kIsList<T>) {
    return {{"type", "array"}, {"items", schema_of<typename T::value_type>(form)}};
  } else if constexpr (detail::kIsArray<T>) {
    return {{"type", "array"},
            {"items", schema_of<typename T::value_type>(form)},
            {"minItems", field.size()},
            {"maxItems", field.size()}};
  } else if constexpr (detail::kIsMap<T>) {
    return {{"type", "object"}, {"additionalProperties", schema_of<typename T::mapped_type>(form)}};
  } else if constexpr (std::is_enum_v<T>) {
    return {{"enum", kEnumNames<T>}};
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<T>) {
    return std::is_unsigned_v<T> ? Json{{"type", "integer"}, {"minimum", 0}}
                                 : Json{{"type", "integer"}};
  } else if constexpr (std::is_floating_point_v<T>) {
    return {{"type", "number"}};
  } else if constexpr (std::is_same_v<T, Json>) {
    return {{"type", "object"}};
  } else {
    static_assert(
        std::is_same_v<T, std::filesystem::path> || std::is_convertible_v<T, std::string_view>,
        "a field with its own functions needs kAs<TYPE> after its description");
    return {{"type", "string"}};
  }
}

}  // namespace vpr
