// Parts of SVG charts.
#pragma once

#include <set>
#include <string>
#include <utility>

namespace vpr {

/// A text whose baseline is at y; anchor is "start", "middle" or "end". An empty one is nothing.
std::string svg_text(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& kind = "");

/// A rectangle of a style sheet's class.
std::string svg_rect(const std::string& kind, double x, double y, double width, double height);

/// Spots of one unit that are taken.
class SpotSet {
 public:
  /// False if the spot was taken before.
  bool add(double x, double y);

 private:
  std::set<std::pair<long, long>> seen_;
};

}  // namespace vpr
