// Result files of version 1, which had two kinds: of sequences and of FAB-MAP.
#pragma once

#include "base/json_fwd.h"
#include "report/json_fields.h"

namespace vpr {

/// Renames and moves the keys of a file of version 1 to where version 2 has them. What is missing
/// stays missing; its arrays still have the columns of their time (match_layout).
void upgrade_result(Json& json, const Fields& fields);

/// The columns of hits.npy and best.npy by version and kind, as indices of columns; `none` where
/// the number stands elsewhere or is 0.
struct MatchLayout {
  static constexpr size_t kNone = static_cast<size_t>(-1);
  size_t columns = 3;
  size_t target = 1;  ///< the query is always the first
  size_t train = 2;
  size_t view = kNone;
  size_t score = kNone;  ///< none: in an array of its own
};

/// The layout of a version, 1 or 2, of results with places (FAB-MAP) or without.
MatchLayout match_layout(int version, bool has_places);

}  // namespace vpr
