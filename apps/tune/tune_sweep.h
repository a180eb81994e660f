// One sweep of vpr-tune after the other; what differs between the families is a Tuner.
#pragma once

#include "base/json.h"
#include "base/stopwatch.h"
#include "tune_inputs.h"

namespace vpr {

/// What is counted on the query of --validate, as JSON.
template <class Tuner>
Json validation_json(const Tuner& tuner, const Source& source, const CellCounts& recommended,
                     const Monitor& monitor) {
  Sweep sweep;
  sweep.query_name = source.sequence.name;
  sweep.score = &tuner.score();
  sweep.cells = tuner.sweep(tuner.describe(source), sweep.query_name, grid_of({&recommended, 1}),
                            reader_of(source.ground_truth, sweep.protocol, monitor));
  Json json;
  add_sweeps(json, {sweep});
  return json["cells"][0];
}

/// A Tuner has
///   score()                             what thresholds are of
///   describe(source)                    frames to what is matched
///   grid(query)                         what to count
///   sweep(query, name, grid, reader)    the cells
///   query(query, cell)                  the result at one of them
///   settings_of(cell)                   everything that vpr-query would be set to
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
    const Grid grid = sweeps.empty() ? tuner.grid(query) : grid_of(sweeps.front().cells);
    sweep.score = &tuner.score();
    sweep.cells = tuner.sweep(query, sweep.query_name, grid, reader);
    sweep.recommendation = recommend(sweep.cells, sweep.score->order);
    if (sweep.recommendation.cell) {
      const CellCounts& recommended = sweep.cells[*sweep.recommendation.cell];
      sweep.recommended_settings = settings_in_force(tuner.settings_of(recommended));
      const Result result = tuner.query(query, recommended);
      sweep.intervals = count_intervals(result, reader(scope_of(result)), session.options.seed);
      if (validation)
        sweep.validation = validation_json(tuner, *validation, recommended, session.monitor);
    }
    sweeps.push_back(std::move(sweep));
  }
  present(session, inputs, sweeps, Tuner::kMethod, settings, watch.elapsed_s());
}

}  // namespace vpr
