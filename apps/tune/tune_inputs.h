// What the commands of vpr-tune share: queries and their ground truth, presentation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "ground_truth/dataset.h"
#include "pipeline/sweep.h"
#include "report/table.h"
#include "tune_grids.h"

namespace vpr {

struct TuneInputs {
  std::string database;
  std::string query;
  std::string ground_truth;
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

/// The queries of --query or --dataset. Throws Error(usage) if there is none, or no ground truth.
std::vector<Source> find_sources(const TuneInputs& inputs, bool is_fabmap);

/// The query of --validate, by its path or, with one data set, its name; warns if a setting is
/// chosen on it.
std::optional<Source> find_validation(const TuneInputs& inputs, const std::vector<Source>& sources,
                                      bool is_fabmap, const Monitor& monitor);

/// Reads the ground truth for a scope, and keeps what it says of itself.
TruthReader reader_of(const GroundTruthArgument& argument, std::string& protocol,
                      const Monitor& monitor);

/// Claims the outputs. Throws Error(usage) if --save-config has several data sets.
void claim_outputs(const TuneInputs& inputs, const Session& session);

/// Writes pictures, plots, configuration and JSON, and prints the tables. Throws
/// Error(expectation), when all else is done, if --save-config has nothing to save.
void present(Session& session, const TuneInputs& inputs, const std::vector<Sweep>& sweeps,
             const std::string& method, const Json& settings, double seconds);

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

/// vpr-tune threshold; `tune` must live as long as the program.
struct ThresholdTune {
  std::string database;
  std::string windows = "40";
  double safety_factor = 1;
  Score score = Score::raw;
  double safety_margin = 0;  ///< of standardized scores
  StandardizationSettings standardization;
  bool write = false;
  size_t memory_limit = kDefaultMemoryLimit;
  TableFormat format = TableFormat::text;
};

template <class Visitor>
void visit_fields(ThresholdTune& settings, Visitor&& visit) {
  visit("safety_factor", settings.safety_factor);
  visit("score", settings.score);
  visit("safety_margin", settings.safety_margin);
  visit("standardization", settings.standardization);
}

void add_threshold(Program& program, ThresholdTune& tune);

}  // namespace vpr
