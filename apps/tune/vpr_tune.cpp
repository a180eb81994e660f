// vpr-tune: chooses a method and its settings on queries with ground truth.
#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "query/advice.h"
#include "query/open.h"
#include "query/train_sequences.h"
#include "tune.h"
#include "tune/sweep_report.h"
#include "tune/trials.h"

namespace vpr {
namespace {

/// The program without a command.
struct Try {
  TuneOptions options;
  SequenceQuerySettings settings{Filter{}};  ///< the default filter
  uint64_t max_incorrect = 0;
};

template <class Visitor>
void visit_fields(Try& command, Visitor&& visit) {
  visit("max_incorrect", command.max_incorrect);
  visit("only_sequence", command.settings.only_sequences);
  visit("same_place", std::get<Filter>(command.settings.rule).same_place);
  visit("skip_unreadable", command.settings.skip_unreadable);
}

Trial fabmap_trial(const Try& command, const Session& session) {
  const Monitor& monitor = session.monitor;
  const FabmapDatabase database = read_fabmap_database(command.options.fabmap);
  FabmapQuerySettings settings;
  settings.skip_unreadable = command.settings.skip_unreadable;
  const std::vector<Source> sources =
      find_queries(command.options, DatabaseFamily::fabmap, session);
  std::vector<LabeledWords> queries;
  for (const Source& source : sources)
    queries.push_back({source.sequence.name,
                       describe_words(open_sequence(source.sequence.sequence), database,
                                      settings.skip_unreadable, monitor),
                       evaluation_of(source, nullptr)});
  return try_fabmap(database, queries, settings, command.max_incorrect,
                    session.options.process.seed, monitor);
}

std::string result_text(const Try& command, const CommonOptions& common, const Trials& trials,
                        const std::string& advice) {
  const auto& [options, settings, max_incorrect] = command;
  std::string text = render_table(trials_table(trials, common.verbose), options.format);
  if (options.format != TableFormat::text) return text;  // of other programs
  text += choice_text(trials, advice);
  if (trials.chosen)
    text += query_command(options, common, trials.all[*trials.chosen].settings) + "\n";
  if (!common.verbose) return text;
  TuneOptions flags = options;
  flags.save_config.clear();
  for (const Trial& trial : trials.all)
    text += fmt::format("{}:\n{}\n", trial.name, query_command(flags, common, trial.settings));
  return text;
}

void try_all(Session& session, const Try& command) {
  const TuneOptions& options = command.options;
  const Monitor& monitor = session.monitor;
  if (options.database.empty())
    throw Error(ErrorKind::usage, "the database is missing, as in vpr-tune DB --query FOLDER");
  session.claim_output({options.save_config});
  const std::vector<Source> sources = find_queries(options, DatabaseFamily::sequences, session);
  const SequenceQuerySettings& settings = command.settings;
  const SequenceDatabase database = open_database(options.database, settings, monitor);
  const QueryResources resources{options.memory_limit, session.options.process.seed};
  const Stopwatch watch;
  std::vector<LabeledQuery> queries;
  for (const Source& source : sources)
    queries.push_back({source.sequence.name,
                       describe_query(source.sequence.sequence, database, settings, monitor),
                       evaluation_of(source, &database)});
  Trials trials =
      try_sequences(database, queries, settings, command.max_incorrect, resources, monitor);
  if (!options.fabmap.empty()) {
    trials.all.push_back(fabmap_trial(command, session));
    choose(trials);
  }
  session.run.memory_limit = options.memory_limit;
  session.run.paths = {{"database", options.database}};
  const Json json = trials_json(trials, session.run, watch.elapsed_s());
  session.write_output(json);
  if (!options.save_config.empty() && trials.chosen)
    session.outputs.file(options.save_config)
        .write(config_text(trials.all[*trials.chosen].settings));
  const std::string advice =
      session.prints_text() && trials.all.front().total().path.recognized == 0
          ? filter_advice(database, queries.front().frames, settings, resources, monitor)
          : "";
  session.print_result(result_text(command, session.options, trials, advice), json);
  if (!options.save_config.empty() && !trials.chosen)
    throw Error(ErrorKind::expectation, "{}: is not written, because no setting is chosen",
                options.save_config);
}

void add_trials(Program& program) {
  const auto tune = std::make_shared<Try>();
  TuneOptions& options = tune->options;
  const Command command = program.command();
  program.set_run([tune](Session& session) { try_all(session, *tune); });
  program.add_config(command, *tune);
  add_query_flags(command, options);
  command.add_option(
      "--fabmap", options.fabmap,
      "FAB-MAP database of the same sequences; to try it as well, by the same ground truth");
  add_setting(command, "--max-incorrect", tune->max_incorrect,
              "most incorrect frames of a choice (default: 0)");
  command.add_option("--save-config", options.save_config,
                     "chosen settings for vpr-query --config; exit code 5 if there are none");
  add_unreadable_flag(command, tune->settings.skip_unreadable).group("Query");
  add_memory_flag(command, options.memory_limit);
  add_format_flag(command, options.format).group("Outputs");
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-tune", "Find the method and settings for your data, by ground truth.",
                  "  vpr-tune corridor.vprdb --query tuesday --ground-truth pairs.csv\n"
                  "  vpr-tune corridor.vprdb --query tuesday --ground-truth pairs.csv "
                  "--save-config best.json\n"
                  "  vpr-query corridor.vprdb --query wednesday --config best.json");
  add_trials(program);
  add_fastable(program);
  add_fabmap(program);
  add_threshold(program);
  return program.main(argc, argv);
}
