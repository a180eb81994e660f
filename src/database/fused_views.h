// What FAB-MAP knows of the training frames of a database of sequences.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "database/fabmap_database.h"
#include "descriptors/vocabulary.h"

namespace vpr {

/// FAB-MAP's database of the same training frames, each of which is one of its views.
struct FusedViews {
  /// Of a frame that could not be decoded.
  static constexpr uint32_t kNoView = std::numeric_limits<uint32_t>::max();

  FabmapDatabase fabmap;
  Vocabulary vocabulary;        ///< of it, for frames to be described by
  std::vector<size_t> frames;   ///< of each training sequence
  std::vector<uint32_t> views;  ///< by training frame, sequence after sequence
  std::vector<WordSet> words;   ///< that the same frames show
};

}  // namespace vpr
