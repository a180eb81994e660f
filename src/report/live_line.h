// What is said of a query frame as soon as it has come: one line of JSON.
#pragma once

#include <string>

#include "base/json.h"
#include "recognition/result.h"

namespace vpr {

/// The newest frame of a query.
struct LineFrame {
  size_t number = 0;
  std::string name;
  bool is_readable = true;
};

/// docs/live.schema.json. `window`: the query window of the result that ends with the frame; none
/// where the frames before it do not fill one.
Json live_line(const LineFrame& frame, const Result* result, size_t window);

}  // namespace vpr
