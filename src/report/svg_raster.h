// SVG to PNG, by librsvg.
#pragma once

#include <string>

namespace vpr {

/// The bytes of a PNG file that shows a whole SVG file, `zoom` pixels to its unit, on white.
/// Images in it are
/// data: nothing else is opened. Throws Error(internal) if it is no SVG, or too large to draw.
std::string png_of_svg(const std::string& svg, double zoom);

}  // namespace vpr
