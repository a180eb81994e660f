// The map of vpr-eval: --map, with one result or two.
#pragma once

#include <string>

#include "common/command.h"

namespace vpr {

struct Evaluated;

struct MapInputs {
  std::string folder;
  std::string with;  ///< a second result
};

void add_map_options(const Command& app, MapInputs& inputs);

/// Throws Error(usage) for flags that do not go together, and as the checks of outputs do. Call it
/// before long work.
void check_map_inputs(const Session& session, const MapInputs& inputs, const std::string& dataset);

/// Draws the map. `second`: the evaluation of the other result, or none. Throws Error(usage) if the
/// data set does not say where the query's frames were taken.
void write_map(Session& session, const MapInputs& inputs, const std::string& dataset,
               const Evaluated& first, const Evaluated* second);

}  // namespace vpr
