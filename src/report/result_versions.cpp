#include "report/result_versions.h"

#include <utility>

namespace vpr {
namespace {

void rename(Json& object, const char* from, const char* to) {
  if (!object.is_object() || !object.contains(from)) return;
  object[to] = std::move(object[from]);
  object.erase(from);
}

void rename_each(Json& json, const char* list, const char* from, const char* to) {
  if (json.contains(list) && json[list].is_array())
    for (Json& item : json[list]) rename(item, from, to);
}

void upgrade_places(Json& json, const Fields& fields) {
  const size_t places = fields.list("places").size();
  json["places"] = {{"names", std::move(json["places"])}, {"views", fields["views"]}};
  json.erase("views");
  json["targets"] = Json::array(
      {{{"name", "places"}, {"frames", places}, {"windows", places}, {"searched", true}}});
  if (json["query"].is_object() && json["query"].contains("frames"))
    json["query"]["windows"] = json["query"]["frames"];
}

}  // namespace

void upgrade_result(Json& json, const Fields& fields) {
  if (json.contains("places")) return upgrade_places(json, fields);
  rename(json, "sequences", "targets");
  rename_each(json, "targets", "distance_limit", "limit");
  rename(json, "recognitions", "clusters");
  rename_each(json, "clusters", "sequence", "target");
  rename_each(json, "clusters", "best_distance", "best_score");
}

MatchLayout match_layout(int version, bool has_places) {
  if (version > 1) return has_places ? MatchLayout{4, 1, 2, 3} : MatchLayout{};
  if (has_places) return {3, MatchLayout::kNone, 1, 2};
  return {4, 1, 2, MatchLayout::kNone, 3};
}

}  // namespace vpr
