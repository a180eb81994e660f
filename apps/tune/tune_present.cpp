// What vpr-tune writes and prints.
#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "present/sweep_report.h"
#include "tune_inputs.h"

namespace vpr {
namespace {

// The flags of the recommended setting that are not vpr-query's defaults; those that came from a
// configuration file come from it again.
std::vector<std::string> setting_flags(const QuerySettings& recommended) {
  const Json settings = settings_in_force(recommended);
  std::vector<std::string> flags;
  for (const auto& [key, flag] :
       {std::pair("c_l", "--c-l"), std::pair("t_r", "--t-r"), std::pair("decide", "--decide"),
        std::pair("margin", "--margin"), std::pair("margin_width", "--margin-width"),
        std::pair("c_w", "--c-w"), std::pair("t_p", "--t-p"), std::pair("score", "--score"),
        std::pair("fuse_beta", "--fuse-beta")})
    if (settings.contains(key)) {
      const Json& value = settings[key];
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      flags.push_back(fmt::format("{}{}{}", flag, text.starts_with('-') ? "=" : " ", text));
    }
  if (settings.value("t_r_scale", "") == enum_name(ThresholdScale::bits))
    flags.emplace_back("--t-r-scale bits");
  if (settings.value("skip_unreadable", false)) flags.emplace_back("--skip-unreadable");
  return flags;
}

// Runs the recommended setting on the query that it was chosen on.
std::string query_command(const TuneInputs& inputs, const CommonOptions& options,
                          const Sweep& sweep, size_t index) {
  std::vector<std::string> words = {"vpr-query", shell_word(inputs.database)};
  if (!inputs.datasets.empty()) {
    words.push_back("--dataset " + shell_word(inputs.datasets[index]));
    if (!inputs.query.empty()) words.push_back("--query " + shell_word(inputs.query));
  } else {
    words.push_back("--query " + shell_word(inputs.query));
  }
  if (!inputs.fuse.empty()) words.push_back("--fuse " + shell_word(inputs.fuse));
  const std::string& config = inputs.save_config.empty() ? options.config : inputs.save_config;
  if (!config.empty()) words.push_back("--config " + shell_word(config));
  if (inputs.save_config.empty())
    for (const std::string& flag : setting_flags(*sweep.recommended_settings))
      words.push_back(flag);
  return fmt::format("{}", fmt::join(words, " "));
}

std::string result_text(const TuneInputs& inputs, const CommonOptions& options,
                        const std::vector<Sweep>& sweeps) {
  if (inputs.format == TableFormat::csv) return render_table(cells_table(sweeps), TableFormat::csv);
  std::string text;
  for (const Table& table : sweep_tables(sweeps)) text += render_table(table, inputs.format) + "\n";
  for (size_t s = 0; s < sweeps.size(); ++s) {
    text += recommendation_text(sweeps[s]);
    if (!sweeps[s].recommendation.cell) continue;
    if (sweeps[s].validation) text += validation_text(*sweeps[s].validation);
    text += fmt::format("  {} -o result.json\n", query_command(inputs, options, sweeps[s], s));
  }
  return text;
}

void draw_plots(Session& session, const TuneInputs& inputs, const std::vector<Sweep>& sweeps) {
  const Output& folder = session.outputs.folder(inputs.plots, is_marked_folder);
  for (size_t s = 0; s < sweeps.size(); ++s) {
    Chart chart = sweep_chart(sweeps[s]);
    if (sweeps.size() > 1) chart.file += fmt::format("-{}", s + 1);
    draw_chart(chart, folder.temporary());
  }
}

}  // namespace

void claim_outputs(const TuneInputs& inputs, const Session& session) {
  for (const std::string& file : {session.options.output, inputs.heat_map, inputs.save_config})
    if (!file.empty()) session.outputs.claim_file(file);
  if (!inputs.plots.empty()) session.outputs.claim_folder(inputs.plots, is_marked_folder);
  if (!inputs.save_config.empty() && inputs.datasets.size() > 1)
    throw Error(ErrorKind::usage,
                fmt::format("--save-config keeps one recommendation, and each of {} data sets has "
                            "its own; sweep them one by one",
                            inputs.datasets.size()));
}

void present(Session& session, const TuneInputs& inputs, DatabaseFamily family,
             const QuerySettings& base, const std::vector<Sweep>& sweeps, double seconds) {
  session.run.simd_target = session.kernels.target;
  session.run.paths = {{"database", inputs.database}};
  const Json json = sweep_json(enum_name(family), base, sweeps, session.run, seconds);
  const std::optional<QuerySettings>& recommended = sweeps.front().recommended_settings;
  session.write_output(json);
  if (!inputs.heat_map.empty()) session.outputs.file(inputs.heat_map).write(heat_map_png(sweeps));
  if (!inputs.save_config.empty() && recommended)
    session.outputs.file(inputs.save_config).write(config_text(*recommended));
  if (!inputs.plots.empty()) draw_plots(session, inputs, sweeps);
  session.print_result(result_text(inputs, session.options, sweeps), json);
  if (!inputs.save_config.empty() && !recommended)
    throw Error(ErrorKind::expectation,
                fmt::format("{}: is not written, for no setting is recommended: {}",
                            inputs.save_config, reason_text(sweeps.front())));
}

}  // namespace vpr
