// FAB-MAP's places that a person marked: training frames, and where the query passes them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace vpr {

/// Query frames at most `tolerance` away from `query` show the place.
struct PlaceVisit {
  size_t query = 0;  ///< of the recording
  size_t tolerance = 0;
  size_t line = 0;  ///< in the file
};

/// A training frame that is a place of FAB-MAP.
struct MarkedPlace {
  std::string sequence;                 ///< its name
  size_t frame = 0;                     ///< of the sequence as passed to vpr-train
  std::vector<PlaceVisit> visits = {};  ///< empty: the query does not pass it
};

/// A CSV sequence,train,query,tolerance, in the order of the first row of each place. A row without
/// a query frame is a place that the query does not pass; several rows of a training frame are
/// several visits. Throws Error(input) if it cannot be read, and Error(data), with the line,
/// without rows and for cells that are not frame numbers.
std::vector<MarkedPlace> read_marked_places(const std::filesystem::path& path);

}  // namespace vpr
