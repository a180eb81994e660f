// What the commands of vpr-tune share: queries and their ground truth, presentation.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "common/selection_flags.h"
#include "present/table.h"
#include "run/sweep.h"
#include "truth/dataset.h"
#include "tune_grids.h"

namespace vpr {

struct TuneInputs {
  std::string database;
  std::string query;
  std::string ground_truth;
  std::string fuse;  ///< FAB-MAP's database of the same training sequences, for fastable
  SelectionFlags selection;
  GroundTruthFlags flags;
  std::vector<std::string> datasets;
  GridFlags grid;
  std::string validate;
  std::string validate_ground_truth;
  std::string save_config;
  std::string plots;
  std::string heat_map;
  TableFormat format = TableFormat::text;
};

/// A query and what it is judged by.
struct Source {
  NamedSequence sequence;
  GroundTruthArgument ground_truth;
};

void add_tune_inputs(const Command& command, TuneInputs& inputs);

/// The queries on which settings are chosen, and the one of --validate, on which the recommended
/// setting is reported.
struct Sources {
  std::vector<Source> queries;
  std::optional<Source> validation;
};

/// By paths or, of a data set, by names; warns if a setting is chosen on the validation. Throws
/// Error(usage) if there is no query, or no ground truth.
Sources find_sources(const TuneInputs& inputs, DatabaseFamily family, const Session& session);

/// Claims the outputs. Throws Error(usage) if --save-config has several data sets.
void claim_outputs(const TuneInputs& inputs, const Session& session);

/// What differs between the families: describes the frames of a query and sweeps them, over a grid
/// or, where there is none, over the one of the flags.
using SweepQuery =
    std::function<Sweep(const Source& source, const Grid* grid, const TruthReader& reader)>;

/// Sweeps query after query, all over the grid of the first, and the recommended cell of each on
/// the validation. `database`: as reader_of.
std::vector<Sweep> sweep_all(const Sources& sources, const SequenceDatabase* database,
                             const SweepQuery& sweep, const Monitor& monitor);

/// Writes pictures, plots, configuration and JSON, and prints the tables. `base`: settings of which
/// the sweeps vary two. Throws Error(expectation), when all else is done, if --save-config has
/// nothing to save.
void present(Session& session, const TuneInputs& inputs, DatabaseFamily family,
             const QuerySettings& base, const std::vector<Sweep>& sweeps, double seconds);

/// vpr-tune fastable: what it sets beside the grid. `tune` must live as long as the program.
struct FastableTune {
  TuneInputs inputs;
  SequenceQuerySettings settings;
  size_t memory_limit = kDefaultMemoryLimit;
};
void add_fastable(Program& program, FastableTune& tune);

/// The same for vpr-tune fabmap.
struct FabmapTune {
  TuneInputs inputs;
  FabmapQuerySettings settings;
};
void add_fabmap(Program& program, FabmapTune& tune);

/// vpr-tune calibrate: margins of z-scores, where nothing else is said. `tune` must live
/// as long as the program.
struct CalibrateTune {
  CalibrateTune();
  TuneInputs inputs;
  SequenceQuerySettings settings;
  std::optional<double> precision;
  std::string windows;
  size_t memory_limit = kDefaultMemoryLimit;
};
void add_calibrate(Program& program, CalibrateTune& tune);

/// Reads the ground truth of a source, which may name frames as the query and `database` do; null:
/// FAB-MAP's, whose places have no such names. All arguments must outlive the reader.
TruthReader reader_of(const Source& source, const SequenceDatabase* database,
                      const Monitor& monitor);

/// vpr-tune threshold; `tune` must live as long as the program.
struct ThresholdTune {
  std::string database;
  std::string windows = "40";
  double safety_factor = 1;
  bool write = false;
  TableFormat format = TableFormat::text;
};

template <class Visitor>
void visit_fields(ThresholdTune& settings, Visitor&& visit) {
  visit("safety_factor", settings.safety_factor);
}

void add_threshold(Program& program, ThresholdTune& tune);

}  // namespace vpr
