// What a color means: the one table of colors for pages, plots, maps, matrices and heat maps.
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

enum class Fix;
enum class PlaceLabel;

/// What is drawn.
enum class Meaning {
  right,  ///< recognized, by the ground truth
  wrong,
  unjudged,    ///< recognized, and the pair is to be ignored or there is no ground truth
  weak_right,  ///< a best match that is not recognized
  weak_wrong,
  weak_unjudged,
  truth,
  missed,       ///< not recognized on a map, though the ground truth has the place
  unreachable,  ///< not recognized on a map, and the place is only where no window ends
  unmapped,     ///< not recognized on a map, and the ground truth has no match
  train_path,
  place,  ///< of FAB-MAP
  wall,
  divider,  ///< between sequences
  best_matches,
  all_pairs,
  by_margin,
  asked_margin
};

/// A row of the palette: 0xrrggbb on white and on dark paper.
struct PaletteColor {
  Meaning meaning = Meaning::right;
  std::string_view name;   ///< of its CSS variable and class
  std::string_view words;  ///< what a legend says
  uint32_t light = 0;
  uint32_t dark = 0;
};

/// Every meaning, in the order of Meaning. Colors that stand side by side in one picture can be
/// told apart by people who do not see red, green or blue.
std::span<const PaletteColor> palette();

const PaletteColor& color_of(Meaning meaning);

/// "#rrggbb" on white.
std::string hex_of(Meaning meaning);

/// Blue, green, red on white, as OpenCV stores pixels.
cv::Vec<uint8_t, 3> bgr_of(Meaning meaning);

/// What the fix of a frame means; it is not none.
Meaning meaning_of(Fix fix);

/// What a recognized pair means.
Meaning meaning_of(PlaceLabel label);

/// Colors of curves that mean nothing but their order, "#rrggbb" on white.
std::span<const std::string_view> series_colors();

/// The palette, and colors of curves, as CSS variables, for light and dark pages.
std::string palette_css();

}  // namespace vpr
