#include "tune/trial_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "present/evaluation_text.h"
#include "sequence/sequence_json.h"

namespace vpr {
namespace {

Json counts_json(const FrameCounts& counts) {
  return {{"frames", counts.path.frames_with_match},
          {"correct", counts.path.correct},
          {"incorrect", counts.path.incorrect},
          {"pairs_incorrect", counts.pairs.incorrect},
          {"first", or_null(counts.path.first_recognition_frames)}};
}

void add_counts(Table& table, const std::string& setting, const FrameCounts& counts,
                double seconds) {
  const auto& [path, pairs] = counts;
  add_row(table, setting, path.correct, path.incorrect, pairs.incorrect,
          path.first_recognition_frames ? std::to_string(*path.first_recognition_frames) : "-",
          fmt::format("{:.2f}", 1000 * seconds / static_cast<double>(path.frames)));
}

}  // namespace

Json trials_json(const Trials& trials, const RunInfo& run, double seconds) {
  Json json = {{"schema", schema_name("tuning")},  {"max_incorrect", trials.max_incorrect},
               {"queries", Json::array()},         {"trials", Json::array()},
               {"chosen", or_null(trials.chosen)}, {"settings", nullptr}};
  for (const Sequence& query : trials.queries) {
    json["queries"].push_back({{"name", query.name}, {"frames", query.frames}});
    json["queries"].back().update(value_to_json(query.selection, kDataForm));
  }
  std::map<std::string, double> timing = {{"all", seconds}};
  for (const Trial& trial : trials.all) {
    Json one = counts_json(trial.total());
    one["name"] = trial.name;
    one["settings"] = settings_in_force(trial.settings);
    one["queries"] = Json::array();
    for (const FrameCounts& counts : trial.counts) one["queries"].push_back(counts_json(counts));
    json["trials"].push_back(std::move(one));
    timing[trial.name] = trial.seconds;
  }
  if (trials.chosen) json["settings"] = settings_in_force(trials.all[*trials.chosen].settings);
  json["provenance"] = provenance_json(run);
  add_run(json, run, timing);
  return json;
}

Table trials_table(const Trials& trials, bool by_query) {
  Table table;
  table.columns = {"frames recognized", "correct", "incorrect",
                   "pairs incorrect",   "first",   "ms/frame"};
  for (size_t t = 0; t < trials.all.size(); ++t) {
    const Trial& trial = trials.all[t];
    const FrameCounts total = trial.total();
    add_counts(table, trial.name + (trials.chosen == t ? " *" : ""), total, trial.seconds);
    if (!by_query || trial.counts.size() < 2) continue;
    for (size_t q = 0; q < trial.counts.size(); ++q) {
      const FrameCounts& counts = trial.counts[q];
      add_counts(table, "  " + trials.queries[q].name, counts,
                 trial.seconds * static_cast<double>(counts.path.frames) /
                     static_cast<double>(total.path.frames));
    }
  }
  return table;
}

std::string choice_text(const Trials& trials, const std::string& advice) {
  if (trials.chosen) {
    const Trial& trial = trials.all[*trials.chosen];
    const Localization path = trial.total().path;
    const std::string choice =
        fmt::format("Choice: {}: {} of {} correctly, {} incorrectly.", trial.name, path.correct,
                    counted(path.frames_with_match, "frame"), path.incorrect);
    return wrapped_text(choice, 2) +
           (trial.is_tuned
                ? "Its threshold fits these frames; another recording may need another setting.\n"
                : "Another recording may need another setting.\n");
  }
  const bool any_correct = std::ranges::any_of(
      trials.all, [](const Trial& trial) { return trial.total().path.correct > 0; });
  if (any_correct)
    return fmt::format(
        "No choice: each setting with a correct frame has more than {} (--max-incorrect).\n",
        counted(trials.max_incorrect, "incorrect one"));
  if (!advice.empty()) {
    std::string line = advice;
    std::ranges::replace(line, '\n', ' ');
    return "No choice: no setting recognizes a frame correctly.\n" + wrapped_text(line, 2);
  }
  return "No choice: no setting recognizes a frame correctly, and some are recognized\n"
         "incorrectly. Check the ground truth. The query may show another place.\n";
}

}  // namespace vpr
