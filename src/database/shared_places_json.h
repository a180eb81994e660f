// Which training sequences show the same place, as a database's manifest holds it.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "base/json_fwd.h"
#include "database/archive.h"

namespace vpr {

/// Pairs of sequences a < b, rising.
using SharedPlaces = std::vector<std::pair<size_t, size_t>>;

Json shared_places_to_json(const SharedPlaces& pairs);

/// Throws Error(data) for pairs out of range or order, or where the manifest has none.
SharedPlaces read_shared_places(const Archive& archive, size_t sequences);

}  // namespace vpr
