// What stands and hangs on the walls: doors, boards, posters, lockers, radiators, windows.
#pragma once

#include "synth/surfaces.h"

namespace vpr {

inline constexpr double kSlotM = 2;  ///< walls are furnished slot by slot

/// One slot of a wall. In halls there are fewer doors and larger boards.
void furnish_slot(WallBrush& brush, bool is_hall, bool has_windows);

/// The frames of a glass front, and what one sees through it, over the whole picture.
void paint_glass_front(WallBrush& brush);

}  // namespace vpr
