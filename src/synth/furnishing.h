// Objects on the walls: doors, boards, posters, lockers, radiators, windows.
#pragma once

#include "synth/surfaces.h"

namespace vpr {

inline constexpr double kSlotM = 2;  ///< width of the slots in which walls are furnished

/// Furnishes one slot of a wall. Halls have fewer doors and larger boards.
void furnish_slot(WallBrush& brush, bool is_hall, bool has_windows);

/// Paints the frames of a glass front and the view through it over the whole image.
void paint_glass_front(WallBrush& brush);

}  // namespace vpr
