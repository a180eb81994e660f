#include "database/shared_places_json.h"

#include "base/json.h"

namespace vpr {

Json shared_places_to_json(const SharedPlaces& pairs) {
  Json json = Json::array();
  for (const auto& [a, b] : pairs) json.push_back({a, b});
  return json;
}

SharedPlaces read_shared_places(const Archive& archive, size_t sequences) {
  SharedPlaces pairs;
  for (const Json& item : manifest_list(archive, archive.manifest(), "shared_places")) {
    if (!item.is_array() || item.size() != 2 || !item[0].is_number_unsigned() ||
        !item[1].is_number_unsigned())
      archive.fail("its \"shared_places\" are no pairs of sequences");
    const std::pair pair(item[0].get<size_t>(), item[1].get<size_t>());
    if (pair.first >= pair.second || pair.second >= sequences ||
        (!pairs.empty() && pair <= pairs.back()))
      archive.fail("its \"shared_places\" are out of range or order");
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace vpr
