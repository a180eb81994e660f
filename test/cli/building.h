// A small rendered building for tests of the programs: three corridors with a walk through each.
#pragma once

#include <string>
#include <vector>

#include "base/json.h"

namespace vpr::test {

/// A vpr.world/3 with the requested walks, in this order: "one", "two" and "other" are training
/// walks through one corridor each, "back" and "again" are queries through the corridors of "one"
/// and "two".
inline std::string building(uint64_t seed, const std::vector<std::string>& walks) {
  const auto walk = [](const std::string& name) {
    const bool is_query = name == "back" || name == "again";
    const double y = name == "other" ? 13.25 : name == "two" || name == "again" ? 7.25 : 1.25;
    Json json = {{"name", name}, {"use", is_query ? "query" : "train"}, {"floor", "ground"}};
    json["path"] = is_query ? Json{{2.5, y}, {10.5, y}} : Json{{1, y}, {11.5, y}};
    if (is_query) json["conditions"] = {{"lamps", 0.66}, {"noise", 5}};
    return json;
  };
  Json world = {{"schema", "vpr.world/3"}, {"name", "test"},      {"seed", seed},
                {"image_width", 160},      {"image_height", 120}, {"format", "png"},
                {"resemblance", 0},        {"same_place_m", 1},   {"ignore_m", 1}};
  Json rooms = Json::array();
  for (const double y : {0.0, 6.0, 12.0})
    rooms.push_back({{"x", 0}, {"y", y}, {"width", 14}, {"depth", 2.5}});
  world["floors"] = Json::array({{{"name", "ground"}, {"rooms", rooms}}});
  for (const std::string& name : walks) world["walks"].push_back(walk(name));
  return world.dump();
}

}  // namespace vpr::test
