// Painted surfaces, and how they are looked up without flicker from near and far.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace vpr {

inline constexpr int kTexelsPerMetre = 128;     ///< of walls and people, on level 0
inline constexpr int kPlanTexelsPerMetre = 64;  ///< of floors and ceilings, on level 0

/// Levels of halved size. Pixels are blue, green, red and a fourth value: of walls, how much
/// daylight comes through (255: all of it, no lamp light); of people, how much they cover.
///
/// Walls and people are stored turned: a row is one vertical strip, from the top down, so that what
/// a column of the picture needs lies together. Floors and ceilings are as on the plan.
struct Texture {
  std::vector<cv::Mat> levels;
};

/// Halves until a side is a texel long.
Texture make_texture(const cv::Mat& level_0);

/// Turns a picture as people see it into a wall's strips.
Texture make_wall_texture(const cv::Mat& picture);

/// The level at which a texel is about as large as a pixel, where one pixel covers `texels` of
/// level 0.
size_t choose_level(const Texture& texture, double texels);

/// One vertical strip: the mean over `width` texels around `centre` (both of level 0, the width at
/// least one of the chosen level's), clamped at the ends. `strip` gets as many pixels as a row of
/// the level has.
void filter_strip(const Texture& texture, size_t level, double centre, double width,
                  std::vector<cv::Vec4b>& strip);

}  // namespace vpr
