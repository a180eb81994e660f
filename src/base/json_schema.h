// JSON Schemas of structs, made from the types, descriptions and bounds of their fields
// (base/json.h). Only the generator of docs/schemas uses them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/json.h"

namespace vpr {

/// The keys that a schema requires of all structs in a value.
enum class SchemaForm {
  data,     ///< all keys, except those that a field omits; an optional without a value is null
  partial,  ///< settings that people write: no key but "schema" and those marked kRequired
  in_force  ///< settings in our own files: all keys, except those marked kMayBeMissing
};

/// The schema of a field as a visitor receives it; the object of the field has default values.
template <class Field>
Json field_schema(Field& field, SchemaForm form);

template <class T>
Json schema_of(SchemaForm form = SchemaForm::data) {
  T value{};
  return field_schema(value, form);
}

/// The schema of objects of both schemas: with all keys, of which those of both are required.
Json merged(Json a, const Json& b);

/// A description from the help of a flag, or a sentence as it is.
std::string sentence(std::string_view text);

/// The schema of a whole file with one of these schemas.
Json file_schema(std::string_view title, const std::vector<Json>& schemas);

namespace detail {
Json or_null(Json schema);
Json or_auto(Json schema);
Json any_of(std::vector<Json> schemas);
void add_hint(Json& schema, const Bounds& bounds);
void add_hint(Json& schema, const Matches& pattern);
void add_hint(Json& schema, OrNull);
void add_hint(Json&, const auto&) {}
void add_property(Json& object, std::string_view key, const Json& schema, std::string_view text,
                  bool is_required);

inline bool may_be_missing(MayBeMissing hint) { return hint.holds; }
inline bool may_be_missing(const auto&) { return false; }

template <class T>
Json schema_in(const T*, SchemaForm form) {
  return schema_of<T>(form);
}
template <class T>
Json schema_in(const InForce<T>*, SchemaForm) {
  return schema_of<T>(SchemaForm::in_force);
}
template <class... T>
void replace_type(Json& schema, As<T...>, SchemaForm form) {
  schema = any_of({schema_in(static_cast<const T*>(nullptr), form)...});
}
void replace_type(Json&, const auto&, SchemaForm) {}

/// Fields that wrap another one.
template <class Field>
inline constexpr bool kIsOmittable = !Settings<Field> && requires(Field wrapper) {
  wrapper.field;
};
template <class T>
Json held_schema(IfSet<T>&, SchemaForm form) {
  return schema_of<T>(form);
}
template <class T>
Json held_schema(Derived<T>& field, SchemaForm form) {
  return field_schema(field.value, form);
}
template <class Read>
Json held_schema(ReadField<Read>&, SchemaForm) {
  return {{"type", "string"}};
}
template <class T, class Visit>
Json held_schema(NestedList<T, Visit>& field, SchemaForm form) {
  T item{};
  auto object = field.object_of(item);
  return {{"type", "array"}, {"items", field_schema(object, form)}};
}
}  // namespace detail

/// Collects the properties of an object, of a given schema or a new one.
struct SchemaVisitor {
  SchemaForm form = SchemaForm::data;
  Json object = {{"type", "object"},
                 {"properties", Json::object()},
                 {"required", Json::array()},
                 {"additionalProperties", false}};

  template <class Field, class... Hints>
  void operator()(std::string_view key, Field&& field, std::string_view text = {},
                  const Hints&... hints) {
    using T = std::remove_cvref_t<Field>;
    if constexpr (std::is_same_v<T, Derived<std::string>>)
      if (key == "schema")
        return detail::add_property(object, key, {{"const", field.value}},
                                    "Kind and version of the file.", true);
    Json schema = field_schema(field, form);
    (detail::replace_type(schema, hints, form), ...);
    (detail::add_hint(schema, hints), ...);
    const bool is_required = (std::is_same_v<Hints, Required> || ...) ||
                             (form != SchemaForm::partial && !detail::kIsOmittable<T> &&
                              !(detail::may_be_missing(hints) || ...));
    detail::add_property(object, key, schema, text, is_required);
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
  } else if constexpr (detail::kIsOmittable<T>) {
    return field_schema(field.field, form);
  } else if constexpr (detail::kIsOptional<T>) {
    Json schema = schema_of<typename T::value_type>(form);
    return form == SchemaForm::data ? detail::or_null(schema) : detail::or_auto(schema);
  } else if constexpr (detail::kIsList<T> || detail::kIsArray<T>) {
    Json schema = {{"type", "array"}, {"items", schema_of<typename T::value_type>(form)}};
    if constexpr (detail::kIsArray<T>) schema["maxItems"] = schema["minItems"] = field.size();
    return schema;
  } else if constexpr (detail::kIsMap<T>) {
    return {{"type", "object"}, {"additionalProperties", schema_of<typename T::mapped_type>(form)}};
  } else if constexpr (std::is_enum_v<T>) {
    return {{"enum", kEnumNames<T>}};
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_arithmetic_v<T>) {
    Json schema = {{"type", std::is_integral_v<T> ? "integer" : "number"}};
    if constexpr (std::is_unsigned_v<T>) schema["minimum"] = 0;
    return schema;
  } else {
    constexpr bool is_text =
        std::is_same_v<T, std::filesystem::path> || std::is_convertible_v<T, std::string_view>;
    return is_text ? Json{{"type", "string"}} : Json{{"type", "object"}};
  }
}

}  // namespace vpr
