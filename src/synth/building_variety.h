// What makes the parts of a building differ, and one day or walk from another. Each setting is off
// at 0, and then nothing that is drawn by chance changes.
#pragma once

namespace vpr {

/// How much a building varies.
struct BuildingVariety {
  double finishes = 0;      ///< 0 to 1: paint, flooring, ceiling and lamps differ between rooms
  double bareness = 0;      ///< 0 to 1: share of walls with nothing but doors, windows and fittings
  double wear = 0;          ///< 0 to 1: stains, scuffs, faded and mended paint
  double window_light = 0;  ///< 0 to 10: daylight that falls in through windows and glass fronts
  double far_view = 0;      ///< 0 to 1: how much of what is outside is far away, beyond parallax
  double reflections = 0;   ///< 0 to 1: share of light that glass reflects
  double changes = 0;       ///< 0 to 1: share of places at walls that are otherwise on another day
  double hands = 0;         ///< 0 to 3: how differently a phone is held from walk to walk
};

template <class Visitor>
void visit_fields(BuildingVariety& variety, Visitor&& visit) {
  visit("finishes", variety.finishes);
  visit("bareness", variety.bareness);
  visit("wear", variety.wear);
  visit("window_light", variety.window_light);
  visit("far_view", variety.far_view);
  visit("reflections", variety.reflections);
  visit("changes", variety.changes);
  visit("hands", variety.hands);
}

}  // namespace vpr
