// Floors and ceilings of a plan, as pictures.
#pragma once

#include "synth/baked_light.h"
#include "synth/texture.h"

namespace vpr {

/// The flooring: tiles, the same throughout or each room's own, with dirt.
Texture paint_floor(const Setting& setting, const Baked& light);

/// The ceiling, with lamps, some of them broken.
Texture paint_ceiling(const Setting& setting, const Baked& light);

}  // namespace vpr
