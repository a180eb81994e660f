// Parts of SVG charts.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "report/frame_axis.h"

namespace vpr {

/// Text whose baseline is at y; anchor is "start", "middle" or "end".
std::string svg_text(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& kind = "");

/// A rectangle of a style sheet's class.
std::string svg_rect(const std::string& kind, double x, double y, double width, double height);

/// Small rectangles of one class as one path, no two on the same spot.
class SvgMarks {
 public:
  explicit SvgMarks(std::string kind) : kind_(std::move(kind)) {}
  void add(double x, double y, double width, double height);
  std::string svg() const;

 private:
  std::string kind_;
  std::set<std::pair<long, long>> seen_;
  std::string path_;
};

/// The rectangle that a chart plots into.
struct PlotArea {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

/// A grid line and its label on the x axis, at `share` of the way from the left.
std::string svg_x_tick(const PlotArea& area, double share, const std::string& label);

/// The same on the y axis, from below.
std::string svg_y_tick(const PlotArea& area, double share, const std::string& label);

/// Below the x axis, and above the y axis, where it can't run into tick labels.
std::string svg_axis_titles(const PlotArea& area, const std::string& x, const std::string& y);

}  // namespace vpr
