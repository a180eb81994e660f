#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "evaluate/report.h"
#include "present/chart.h"

using namespace vpr;

namespace {

using Triple = std::array<double, 3>;
using Transform = std::array<Triple, 3>;

// Machado, Oliveira and Fernandes (2009), severity 1, on linear RGB.
constexpr Transform kNormal = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr Transform kProtan = {{{0.152286, 1.052583, -0.204868},
                                {0.114503, 0.786281, 0.099216},
                                {-0.003882, -0.048116, 1.051998}}};
constexpr Transform kDeutan = {{{0.367322, 0.860646, -0.227968},
                                {0.280085, 0.672501, 0.047413},
                                {-0.011820, 0.042940, 0.968881}}};
constexpr Transform kTritan = {{{1.255528, -0.076749, -0.178779},
                                {-0.078411, 0.930809, 0.147602},
                                {0.004733, 0.691367, 0.303900}}};
constexpr Transform kXyz = {{{.4124 / .9505, .3576 / .9505, .1805 / .9505},
                             {.2126, .7152, .0722},
                             {.0193 / 1.089, .1192 / 1.089, .9505 / 1.089}}};

Triple times(const Transform& transform, const Triple& v) {
  Triple result;
  for (size_t r = 0; r < 3; ++r)
    result[r] = transform[r][0] * v[0] + transform[r][1] * v[1] + transform[r][2] * v[2];
  return result;
}

Triple linear(uint32_t rgb) {
  Triple result;
  for (size_t c = 0; c < 3; ++c) {
    const double share = double(rgb >> (16 - 8 * c) & 255) / 255;
    result[c] = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  }
  return result;
}

Triple lab(Triple rgb) {
  for (double& c : rgb) c = std::clamp(c, 0.0, 1.0);
  Triple f = times(kXyz, rgb);
  for (double& c : f) c = c > 0.008856 ? std::cbrt(c) : 7.787 * c + 16.0 / 116;
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

/// The smallest difference (CIE 1976) for any eye.
double difference(uint32_t a, uint32_t b) {
  double least = 1e9;
  for (const Transform& eye : {kNormal, kProtan, kDeutan, kTritan}) {
    const Triple x = lab(times(eye, linear(a)));
    const Triple y = lab(times(eye, linear(b)));
    least = std::min(least, std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]));
  }
  return least;
}

constexpr uint32_t kPaper = 0xffffff;
constexpr uint32_t kDarkPaper = 0x14181e;

}  // namespace

TEST_CASE("the palette has an entry for every meaning, and no color twice") {
  std::set<uint32_t> colors;
  for (size_t i = 0; i < palette().size(); ++i) {
    CHECK(static_cast<size_t>(palette()[i].meaning) == i);
    CHECK(colors.insert(palette()[i].light).second);
  }
  CHECK(palette().size() == static_cast<size_t>(Meaning::required_margin) + 1);
  CHECK(bgr_of(Meaning::correct) == cv::Vec3b(0xc7, 0x68, 0x16));
}

TEST_CASE("adjacent colors differ for every eye, on light and dark backgrounds") {
  const std::vector<std::vector<Meaning>> pictures = {
      {Meaning::correct, Meaning::incorrect, Meaning::weak_correct, Meaning::weak_incorrect,
       Meaning::truth, Meaning::unjudged},
      {Meaning::unjudged, Meaning::weak_unjudged},
      {Meaning::correct, Meaning::incorrect, Meaning::missed, Meaning::unmapped,
       Meaning::train_path, Meaning::place},
      {Meaning::best_matches, Meaning::all_pairs, Meaning::by_margin},
      {Meaning::correct, Meaning::incorrect, Meaning::unjudged, Meaning::required_margin}};
  for (const auto& picture : pictures)
    for (size_t i = 0; i < picture.size(); ++i) {
      const PaletteColor& a = color_of(picture[i]);
      CHECK(difference(a.light, kPaper) > 14);
      CHECK(difference(a.dark, kDarkPaper) > 14);
      for (size_t k = 0; k < i; ++k) {
        const PaletteColor& b = color_of(picture[k]);
        INFO(a.name << " next to " << b.name);
        CHECK(difference(a.light, b.light) > 14);
        CHECK(difference(a.dark, b.dark) > 14);
      }
    }
}

TEST_CASE("a page's variables equal the palette's colors") {
  const std::string css = palette_css();
  const size_t dark = css.find("prefers-color-scheme: dark");
  for (const PaletteColor& row : palette()) {
    const size_t at = css.find(fmt::format("--{}: #{:06x};", row.name, row.light));
    CHECK(at < dark);
    CHECK(css.find(fmt::format("--{}: #{:06x};", row.name, row.dark), dark) != std::string::npos);
  }
}
