#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.h"
#include "present/chart.h"

namespace vpr {
namespace {

constexpr double kLine = 20;     // from one line of text to the next
constexpr double kLetters = 13;  // height

std::vector<double> finite_values(const Chart& chart, double std::pair<double, double>::*side) {
  std::vector<double> values;
  for (const Series& series : chart.series)
    for (const auto& point : series.points)
      if (std::isfinite(point.*side)) values.push_back(point.*side);
  return values;
}

// The step of a ladder 1, 2, 5, 10, 20, ... (and below 1) that is at least `least`.
double round_up(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (least <= factor * power * (1 + 1e-9)) return factor * power;
  return 10 * power;
}

double round_down(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most) + 1e-9));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= most * (1 + 1e-9)) return factor * power;
  return power;
}

std::vector<ChartTick> log_ticks(double low, double high, size_t most) {
  std::vector<ChartTick> all;
  std::vector<ChartTick> powers;
  const double end = high * (1 + 1e-9);
  const auto last = static_cast<int>(std::floor(std::log10(end)));
  for (auto power = static_cast<int>(std::floor(std::log10(low) + 1e-9)); power <= last; ++power)
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double at = factor * std::pow(10.0, power);
      if (at < low * (1 - 1e-9) || at > end) continue;
      all.push_back({at, fmt::format("{:g}", at)});
      if (factor == 1.0) powers.push_back(all.back());
    }
  return all.size() <= most || powers.size() < 2 ? all : powers;
}

// At least two, even for a length of 0.
size_t ticks_in(double length, double room) {
  return static_cast<size_t>(std::max(2.0, length / room));
}

double widest(const std::vector<ChartTick>& ticks) {
  double width = 0;
  for (const ChartTick& tick : ticks) width = std::max(width, text_width(tick.text, kLetters));
  return width;
}

// Sets the entries in centered rows and returns their height.
double lay_legend(const Chart& chart, ChartLayout& layout) {
  double x = 0;
  double y = 0;
  size_t row = 0;  // its first entry
  const auto center = [&] {
    for (; row < layout.legend.size(); ++row) layout.legend[row].x += (layout.width - x) / 2;
  };
  for (size_t s = 0; s < chart.series.size(); ++s) {
    if (chart.series[s].name.empty()) continue;
    const double width = text_width(chart.series[s].name, kLetters) + 44;
    if (x > 0 && x + width > layout.width - 20) {
      center();
      x = 0;
      y += kLine;
    }
    layout.legend.push_back({s, x, y});
    x += width;
  }
  center();
  return layout.legend.empty() ? 0 : y + kLine;
}

// Whether horizontal names of bands would overlap.
bool is_steep(const Chart& chart, const ChartLayout& layout) {
  const auto& bands = chart.x.bands;
  for (size_t i = 0; i + 1 < bands.size(); ++i)
    if (layout.x(bands[i + 1].at) - layout.x(bands[i].at) < text_width(bands[i].text, kLetters) + 8)
      return true;
  return !bands.empty() &&
         layout.x(bands.back().at) + text_width(bands.back().text, kLetters) > layout.width;
}

double height_of_names(const Chart& chart, bool is_steep) {
  double most = 0;
  for (const ChartTick& band : chart.x.bands)
    most = std::max(most, text_width(band.text, kLetters));
  return most == 0 ? 0 : is_steep ? std::ceil(most / 2) + kLine : kLine;
}

// Scales an image down to the width of the plot.
void fit_image(const Chart& chart, ChartArea& area) {
  const ChartImage& image = *chart.image;
  const auto length = [](const ChartAxis& axis) {
    return std::abs(axis.range->second - axis.range->first);
  };
  const double width = static_cast<double>(image.width) / image.columns * length(chart.x);
  const double height = static_cast<double>(image.height) / image.rows * length(chart.y);
  const double scale = std::min(1.0, area.width / width);
  area.width = width * scale;
  area.height = std::max(height * scale, std::min(height, 40.0));
}

// Removes ticks whose texts would overlap an earlier one.
void thin_ticks(std::vector<ChartTick>& ticks, const AxisScale& axis, bool is_x) {
  double end = -1e9;  // of the previous text
  std::vector<ChartTick> sorted = ticks;
  std::ranges::stable_sort(sorted, {}, [&](const ChartTick& tick) { return axis(tick.at); });
  ticks.clear();
  for (const ChartTick& tick : sorted) {
    const double half = (is_x ? text_width(tick.text, kLetters) + 8 : kLetters + 2) / 2;
    if (axis(tick.at) - half < end) continue;
    end = axis(tick.at) + half;
    ticks.push_back(tick);
  }
}

// Reduces the area to the aspect ratio of the ranges.
void keep_aspect(ChartLayout& layout) {
  ChartArea& area = layout.area;
  const double width = layout.x.to - layout.x.from;
  const double height = layout.y.to - layout.y.from;
  const double scale = std::min(area.width / width, area.height / height);
  area.left += (area.width - width * scale) / 2;
  area.width = width * scale;
  area.height = height * scale;
}

}  // namespace

double AxisScale::operator()(double value) const {
  const double share =
      is_log ? std::log(value / from) / std::log(to / from) : (value - from) / (to - from);
  return begin + share * (end - begin);
}

double text_width(const std::string& text, double size) {
  return 0.58 * size * static_cast<double>(std::ranges::count_if(text, starts_letter));
}

std::string shortened(const std::string& text, double width) {
  if (text_width(text, kLetters) <= width) return text;
  const double letters = width / text_width("x", kLetters) - 1;
  size_t end = 0;
  for (double kept = 0; end < text.size(); ++end)
    if (starts_letter(text[end]) && ++kept > letters) break;
  return text.substr(0, end) + "…";
}

std::pair<double, double> range_of(const ChartAxis& axis, const std::vector<double>& values) {
  if (axis.range) return *axis.range;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  if (axis.is_log) {
    if (values.empty() || *least <= 0) return {1, 10};
    const double low = round_down(*least);
    return {low, std::max(round_up(*most), 2 * low)};
  }
  if (values.empty()) return {0, 1};
  const double low = axis.from_zero ? std::min(0.0, *least) : *least;
  const double length = *most > low ? *most - low : 1;
  return {low < 0 || !axis.from_zero ? low - 0.03 * length : low, low + 1.04 * length};
}

size_t round_step(size_t length, size_t most) {
  for (size_t power = 1;; power *= 10)
    for (const size_t factor : {1, 2, 5})
      if (length / (factor * power) <= most) return factor * power;
}

std::vector<ChartTick> ticks_of(bool is_log, const std::pair<double, double>& range, size_t most) {
  const double low = std::min(range.first, range.second);
  const double high = std::max(range.first, range.second);
  if (is_log) return log_ticks(low, high, most);
  std::vector<ChartTick> ticks;
  const double step = round_up((high - low) / static_cast<double>(most));
  for (double n = std::ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; ++n)
    ticks.push_back({n * step, fmt::format("{:.6g}", n * step + 0.0)});
  return ticks;
}

ChartLayout layout_of(const Chart& chart, bool for_page) {
  ChartLayout layout;
  layout.width = chart.width;
  const auto [x_from, x_to] =
      range_of(chart.x, finite_values(chart, &std::pair<double, double>::first));
  const auto [y_from, y_to] =
      range_of(chart.y, finite_values(chart, &std::pair<double, double>::second));
  layout.x = {x_from, x_to, chart.x.is_log};
  layout.y = {y_from, y_to, chart.y.is_log};
  ChartArea& area = layout.area;
  layout.y_ticks = chart.y.ticks.empty()
                       ? ticks_of(chart.y.is_log, {y_from, y_to}, ticks_in(chart.height - 160, 55))
                       : chart.y.ticks;
  const bool has_bare_side = chart.is_plan || chart.y.has_text_inside;
  for (ChartTick& tick : layout.y_ticks)
    tick.text = shortened(tick.text, chart.width * (has_bare_side ? 0.9 : 0.6));
  const double side = 24;
  area.left = has_bare_side ? side / 2 : std::max(48.0, std::ceil(widest(layout.y_ticks)) + 16);
  layout.names_width = chart.right;
  for (const ChartTick& band : chart.y.bands)
    layout.names_width = std::max(layout.names_width, text_width(band.text, kLetters) + 8);
  layout.names_width = std::min(layout.names_width, chart.width / 4);
  area.width = chart.width - area.left - side - layout.names_width;
  if (chart.image) {
    fit_image(chart, area);
    const double least = std::min(chart.width, 620.0);
    layout.width = std::max(area.left + area.width + side + layout.names_width, least);
  }
  layout.x_ticks = chart.x.ticks.empty()
                       ? ticks_of(chart.x.is_log, {x_from, x_to}, ticks_in(area.width, 80))
                       : chart.x.ticks;
  layout.x.begin = area.left;
  layout.x.end = area.right();
  thin_ticks(layout.x_ticks, layout.x, true);
  layout.has_steep_names = is_steep(chart, layout);
  layout.names_height = height_of_names(chart, layout.has_steep_names);
  area.top = (for_page || chart.title.empty() ? 8 : 38) + (chart.y.label.empty() ? 0 : kLine + 6) +
             layout.names_height;
  double below = chart.is_plan ? 10 : 22 + (chart.x.label.empty() ? 0 : kLine + 4);
  if (!chart.runs.empty()) below += 30;
  if (chart.image && chart.image->grays) below += for_page ? 40 : 58;
  const double legend_top = below + 14;
  if (!for_page) below = legend_top + lay_legend(chart, layout);
  if (!chart.image)  // plans next to each other have one scale, whatever their legends
    area.height = chart.height - area.top - (chart.is_plan ? legend_top : below) - 6;
  if (chart.is_plan) keep_aspect(layout);
  layout.height = area.bottom() + below + 6;
  for (LegendEntry& entry : layout.legend) entry.y += area.bottom() + legend_top + 10;
  layout.x.begin = area.left;
  layout.x.end = area.right();
  layout.y.begin = area.bottom();
  layout.y.end = area.top;
  if (!chart.y.has_text_inside) thin_ticks(layout.y_ticks, layout.y, false);
  return layout;
}

}  // namespace vpr
