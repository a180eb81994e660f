// One sweep of vpr-tune after the other; what differs between the families is a Tuner.
#pragma once

#include "base/json.h"
#include "base/stopwatch.h"
#include "tune_inputs.h"

namespace vpr {

/// What is counted on the query of --validate, as JSON.
template <class Tuner>
Json validation_json(const Tuner& tuner, const Source& source,
                     const typename Tuner::Cell& recommended, const Monitor& monitor) {
  Sweep sweep;
  sweep.query_name = source.sequence.name;
  Tuner::cells_of(sweep) =
      tuner.sweep(tuner.describe(source), sweep.query_name, Tuner::grid_of({&recommended, 1}),
                  reader_of(source.ground_truth, sweep.protocol, monitor));
  Json json;
  add_sweeps(json, {sweep});
  return json["cells"][0];
}

/// A Tuner has the types Cell (of a sweep) and Grid, and
///   describe(source)                    frames to what is matched
///   grid(query), grid_of(cells)         what to count; the same as an earlier sweep
///   sweep(query, name, grid, reader)    the cells
///   intervals(query, cell, reader)      of one of them
///   settings_json(cell)                 everything that vpr-query would be set to
///   cells_of(sweep)                     where the family's cells are
///   kMethod                             for the file
/// `settings`: what stays the same for all cells.
template <class Tuner>
void tune(Session& session, const TuneInputs& inputs, const Tuner& tuner,
          const std::vector<Source>& sources, const std::optional<Source>& validation,
          const Json& settings) {
  const Stopwatch watch;
  std::vector<Sweep> sweeps;
  for (const Source& source : sources) {
    Sweep sweep;
    sweep.query_name = source.sequence.name;
    const auto query = tuner.describe(source);
    const TruthReader reader = reader_of(source.ground_truth, sweep.protocol, session.monitor);
    const auto grid =
        sweeps.empty() ? tuner.grid(query) : Tuner::grid_of(Tuner::cells_of(sweeps.front()));
    auto& cells = Tuner::cells_of(sweep);
    cells = tuner.sweep(query, sweep.query_name, grid, reader);
    sweep.recommendation = recommend_cell(cells);
    if (sweep.recommendation.cell) {
      const auto& recommended = cells[*sweep.recommendation.cell];
      sweep.recommended_settings = tuner.settings_json(recommended);
      sweep.intervals = tuner.intervals(query, recommended, reader);
      if (validation)
        sweep.validation = validation_json(tuner, *validation, recommended, session.monitor);
    }
    sweeps.push_back(std::move(sweep));
  }
  present(session, inputs, sweeps, Tuner::kMethod, settings, watch.elapsed_s());
}

}  // namespace vpr
