// The colors of pages, charts, maps and matrices, by meaning.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace cv {
template <typename T, int n>
class Vec;
}

namespace vpr {

enum class FrameVerdict;
enum class PlaceLabel;

enum class Meaning {
  correct,  ///< recognized, correct by the ground truth
  incorrect,
  unjudged,      ///< recognized, but labeled ignore or without ground truth
  weak_correct,  ///< a best match that is not recognized
  weak_incorrect,
  weak_unjudged,
  truth,
  truth_outline,  ///< on a matrix
  missed,         ///< on a map: not recognized, with a match in the ground truth
  unmapped,       ///< on a map: not recognized, without a match in the ground truth
  train_path,
  place,  ///< of FAB-MAP
  wall,
  divider,  ///< between sequences
  best_matches,
  all_pairs,
  by_margin,
  required_margin
};

/// An entry of the palette; colors are 0xrrggbb for light and dark pages.
struct PaletteColor {
  Meaning meaning = Meaning::correct;
  std::string_view name;   ///< of the CSS variable and class
  std::string_view words;  ///< in a legend
  uint32_t light = 0;
  uint32_t dark = 0;
};

/// One entry per Meaning, in its order. Colors of one image are distinguishable for people with
/// any color vision deficiency.
std::span<const PaletteColor> palette();

const PaletteColor& color_of(Meaning meaning);

/// Blue, green and red for light pages, as in OpenCV's pixels.
cv::Vec<uint8_t, 3> bgr_of(Meaning meaning);

/// `verdict` must not be none.
Meaning meaning_of(FrameVerdict verdict);

/// For a recognized pair.
Meaning meaning_of(PlaceLabel label);

/// Colors of curves without a meaning, "#rrggbb" for light pages.
std::span<const std::string_view> series_colors();

/// The palette and the colors of curves as CSS variables, for light and dark pages.
std::string palette_css();

}  // namespace vpr
