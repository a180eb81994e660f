#include "tune/trial_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/json_fields.h"
#include "base/text.h"
#include "present/evaluation_text.h"

namespace vpr {
namespace {

Json path_json(const Localization& path) {
  return {{"correct", path.correct},
          {"incorrect", path.incorrect},
          {"first", or_null(path.first_recognition_frames)}};
}

void add_path(Table& table, const std::string& setting, const Localization& path, double seconds) {
  add_row(table, setting, path.correct, path.incorrect,
          path.first_recognition_frames ? std::to_string(*path.first_recognition_frames) : "-",
          fmt::format("{:.2f}", 1000 * seconds / static_cast<double>(path.frames)));
}

}  // namespace

Json trials_json(const Trials& trials, const RunInfo& run, double seconds) {
  Json json = {{"schema", "vpr.tuning/3"},         {"max_incorrect", trials.max_incorrect},
               {"queries", Json::array()},         {"trials", Json::array()},
               {"chosen", or_null(trials.chosen)}, {"settings", nullptr}};
  for (const Sequence& query : trials.queries) {
    json["queries"].push_back({{"name", query.name}, {"frames", query.frames}});
    add_selection(json["queries"].back(), query.selection);
  }
  std::map<std::string, double> timing = {{"all", seconds}};
  for (const Trial& trial : trials.all) {
    Json one = path_json(trial.total());
    one["name"] = trial.name;
    one["settings"] = settings_in_force(trial.settings);
    one["queries"] = Json::array();
    for (const Localization& path : trial.paths) one["queries"].push_back(path_json(path));
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
  table.columns = {"frames recognized", "correct", "incorrect", "first", "ms/frame"};
  for (size_t t = 0; t < trials.all.size(); ++t) {
    const Trial& trial = trials.all[t];
    const Localization total = trial.total();
    add_path(table, trial.name + (trials.chosen == t ? " *" : ""), total, trial.seconds);
    if (!by_query || trial.paths.size() < 2) continue;
    for (size_t q = 0; q < trial.paths.size(); ++q) {
      const Localization& path = trial.paths[q];
      add_path(
          table, "  " + trials.queries[q].name, path,
          trial.seconds * static_cast<double>(path.frames) / static_cast<double>(total.frames));
    }
  }
  return table;
}

std::string choice_text(const Trials& trials, const std::string& advice) {
  if (trials.chosen) {
    const Trial& trial = trials.all[*trials.chosen];
    const Localization path = trial.total();
    const std::string choice =
        fmt::format("Choice: {}: {} of {} correctly, {} incorrectly.", trial.name, path.correct,
                    counted(path.frames, "frame"), path.incorrect);
    return wrapped_text(choice, 2) +
           (trial.is_tuned
                ? "Its threshold fits these frames; another recording may need another setting.\n"
                : "Another recording may need another setting.\n");
  }
  const bool any_correct =
      std::ranges::any_of(trials.all, [](const Trial& trial) { return trial.total().correct > 0; });
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
