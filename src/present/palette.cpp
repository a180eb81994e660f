#include <array>

#include <fmt/format.h>
#include <opencv2/core/matx.hpp>

#include "evaluate/outcomes.h"
#include "present/chart.h"

namespace vpr {
namespace {

constexpr std::array<PaletteColor, 18> kPalette = {{
    {Meaning::correct, "right", "recognized, correct", 0x1668c7, 0x5aa5f5},
    {Meaning::incorrect, "wrong", "recognized, incorrect", 0xd9480f, 0xff8552},
    {Meaning::unjudged, "unjudged", "recognized, not judged", 0xc2268f, 0xffc4ec},
    {Meaning::weak_correct, "weak-right", "best match correct, not recognized", 0x8fbcec, 0x3c6ea8},
    {Meaning::weak_incorrect, "weak-wrong", "best match incorrect, not recognized", 0xefaa86,
     0xa3593c},
    {Meaning::weak_unjudged, "weak-unjudged", "best match, not recognized", 0xdba3c9, 0x7d4a70},
    {Meaning::truth, "truth", "ground truth", 0xbfe3c4, 0x1d4a2c},
    {Meaning::truth_outline, "truth-outline", "ground truth", 0x12a150, 0x3ddc84},
    {Meaning::missed, "missed", "not recognized", 0xd9a400, 0xe0b030},
    {Meaning::unmapped, "unmapped", "nothing to recognize", 0x8b95a3, 0x8b95a3},
    {Meaning::train_path, "train-path", "training path", 0xc9cfd8, 0x454f5c},
    {Meaning::place, "place", "training place", 0x1c2430, 0xe4e8ee},
    {Meaning::wall, "wall", "wall", 0x444444, 0xa0a0a0},
    {Meaning::divider, "divider", "border of sequences", 0xb48ead, 0x7a5c86},
    {Meaning::best_matches, "best-matches", "best matches", 0x334155, 0xcbd5e1},
    {Meaning::all_pairs, "all-pairs", "all pairs", 0x0f8a7a, 0x12a08d},
    {Meaning::by_margin, "by-margin", "best matches by margin", 0xb45309, 0xfbbf24},
    {Meaning::required_margin, "required-margin", "required margin", 0x111827, 0x8a8f98},
}};

// From dark to light, so that neighbors also differ in brightness.
constexpr std::array<std::string_view, 8> kSeries = {"#440154", "#31688e", "#21918c", "#5ec962",
                                                     "#c9a400", "#8c564b", "#7f7f7f", "#e377c2"};

// For dark pages.
constexpr std::array<std::string_view, 8> kDarkSeries = {
    "#c58ae0", "#6fb1e8", "#35c9bd", "#90e27f", "#f2d04a", "#d69a8a", "#b5b5b5", "#f7a8de"};

std::string variables(std::span<const std::string_view> series) {
  std::string css;
  for (size_t i = 0; i < series.size(); ++i) css += fmt::format(" --series-{}: {};", i, series[i]);
  return css;
}

std::string variables(uint32_t PaletteColor::*color) {
  std::string css;
  for (const PaletteColor& row : kPalette)
    css += fmt::format(" --{}: #{:06x};", row.name, row.*color);
  return css;
}

}  // namespace

std::span<const PaletteColor> palette() { return kPalette; }

const PaletteColor& color_of(Meaning meaning) { return kPalette[static_cast<size_t>(meaning)]; }

cv::Vec3b bgr_of(Meaning meaning) {
  const uint32_t rgb = color_of(meaning).light;
  return {static_cast<uint8_t>(rgb), static_cast<uint8_t>(rgb >> 8),
          static_cast<uint8_t>(rgb >> 16)};
}

std::span<const std::string_view> series_colors() { return kSeries; }

Meaning meaning_of(Verdict verdict) {
  return verdict == Verdict::correct     ? Meaning::correct
         : verdict == Verdict::incorrect ? Meaning::incorrect
                                         : Meaning::unjudged;
}

std::string palette_css() {
  std::string css =
      fmt::format(":root {{{} }}\n@media (prefers-color-scheme: dark) {{ :root {{{} }} }}\n",
                  variables(&PaletteColor::light) + variables(kSeries),
                  variables(&PaletteColor::dark) + variables(kDarkSeries));
  for (const PaletteColor& row : kPalette)
    css += fmt::format("svg .{0} {{ fill: var(--{0}); }} svg .line.{0} {{ stroke: var(--{0}); }}\n",
                       row.name);
  for (size_t i = 0; i < kSeries.size(); ++i)
    css += fmt::format(
        "svg .series-{0} {{ fill: var(--series-{0}); }} svg .line.series-{0} {{ stroke: "
        "var(--series-{0}); }}\n",
        i);
  return css;
}

}  // namespace vpr
