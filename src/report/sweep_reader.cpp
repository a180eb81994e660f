#include <limits>

#include <fmt/format.h>

#include "base/json.h"
#include "report/json_fields.h"
#include "report/sweep_file.h"

namespace vpr {
namespace {

constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();

double read_number(const Fields& fields, const std::string& key) {
  const Json& value = fields[key];
  if (!value.is_number()) fields.fail(fmt::format("\"{}\" is no number", key));
  return value.get<double>();
}

LabelCounts read_labels(const Fields& counts) {
  return {counts.count("correct", kMost), counts.count("incorrect", kMost),
          counts.count("ignored", kMost)};
}

BestMatchCounts read_best(const Fields& best) {
  BestMatchCounts counts;
  counts.queries = best.count("queries", kMost);
  counts.correct = best.count("correct", kMost);
  counts.ignored = best.count("ignored", kMost);
  return counts;
}

SequenceCellCounts read_sequence_cell(const Fields& cell) {
  SequenceCellCounts read;
  read.window_length = cell.count("c_l", kMost);
  if (cell["t_r"] != "auto") read.distance_threshold = read_number(cell, "t_r");
  const auto scale = enum_value<ThresholdScale>(cell.text("t_r_scale"));
  if (!scale) cell.fail("a scale is unknown");
  read.scale = *scale;
  const Fields counts = cell.object("counts");
  read.counts.hits = read_labels(counts.object("hits"));
  read.counts.places = read_labels(counts.object("places"));
  if (counts.has("mixed_places")) read.counts.mixed_places = counts.count("mixed_places", kMost);
  read.counts.distinct = counts.count("distinct", kMost);
  read.counts.best_match = read_best(cell.object("best_match"));
  return read;
}

FabmapCellCounts read_fabmap_cell(const Fields& cell) {
  FabmapCellCounts read;
  read.window = cell.count("c_w", kMost);
  read.place_threshold = read_number(cell, "t_p");
  const Fields counts = cell.object("counts");
  read.counts.hits = read_labels(counts.object("hits"));
  read.counts.distinct = counts.count("distinct", kMost);
  read.counts.best_match = read_best(cell.object("best_match"));
  return read;
}

Interval read_interval(const Fields& fields, const std::string& key) {
  const Json& pair = fields.list(key);
  if (pair.size() != 2 || !pair[0].is_number() || !pair[1].is_number())
    fields.fail("an interval is no pair of numbers");
  return {pair[0].get<double>(), pair[1].get<double>()};
}

}  // namespace

std::vector<Sweep> read_sweeps(const Json& json, const std::string& where) {
  const Fields fields(json, where);
  std::vector<Sweep> sweeps;
  for (const Json& item : fields.list("queries")) {
    const Fields query(item, where);
    Sweep& sweep = sweeps.emplace_back();
    sweep.query_name = query.text("name");
    sweep.protocol = query.text("ground_truth");
    if (item.contains("intervals")) {
      const Fields intervals = query.object("intervals");
      sweep.intervals = {intervals.count("block", kMost),
                         read_interval(intervals, "correct_hits"),
                         read_interval(intervals, "incorrect_hits"),
                         {},
                         {}};
      if (item["intervals"].contains("correct_places")) {
        sweep.intervals->correct_places = read_interval(intervals, "correct_places");
        sweep.intervals->incorrect_places = read_interval(intervals, "incorrect_places");
      }
    }
    if (item.contains("recommended_settings") && item["recommended_settings"].is_object())
      sweep.recommended_settings = item["recommended_settings"];
    if (item.contains("validation")) sweep.validation = item["validation"];
  }
  // Each query has as many cells, in the order of queries.
  const Json& cells = fields.list("cells");
  if (sweeps.empty() || cells.size() % sweeps.size() != 0)
    fields.fail("its cells do not fit its queries");
  const size_t each = cells.size() / sweeps.size();
  for (size_t c = 0; c < cells.size(); ++c) {
    Sweep& sweep = sweeps[c / each];
    const Fields cell(cells[c], where);
    if (cells[c].contains("c_l"))
      sweep.sequence_cells.push_back(read_sequence_cell(cell));
    else
      sweep.fabmap_cells.push_back(read_fabmap_cell(cell));
  }
  for (Sweep& sweep : sweeps) {
    std::vector<SweepScore> scores;
    for (const auto& cell : sweep.sequence_cells) scores.push_back(score_of(cell));
    for (const auto& cell : sweep.fabmap_cells) scores.push_back(score_of(cell));
    sweep.recommendation = recommend(scores);
  }
  return sweeps;
}

}  // namespace vpr
