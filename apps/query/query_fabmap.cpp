// vpr-query against a FAB-MAP database.
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "decide/clustering.h"
#include "explain_fabmap.h"
#include "fabmap/openfabmap.h"
#include "present/explanation_report.h"
#include "present/result_file.h"
#include "present/score_matrix.h"
#include "present/table.h"
#include "query_inputs.h"
#include "query_loop.h"
#include "run/fabmap_query.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

constexpr size_t kTableRows = 20;

struct WordQuery {
  std::string name;
  std::string path;
  std::optional<SequenceArgument> images;  // none for a BOW matrix
  SequenceWords words;
};

WordQuery read_query(const QueryInputs& inputs, const FabmapDatabase& database,
                     bool skip_unreadable, const Session& session) {
  WordQuery query;
  if (!inputs.query_bow.empty()) {
    const SequenceArgument argument = parse_sequence_argument(inputs.query_bow);
    query.name = sequence_names({argument}).front();
    query.path = argument.path.string();
    SequenceWords rows{{}, read_openfabmap_frames(argument, database.tree.words())};
    rows.sequence.frames = rows.words.size();
    const Selection shown =
        warped(inputs.selection.warp, rows.sequence.frames, session.options.seed);
    query.words = selected(std::move(rows), shown);
    return query;
  }
  const QuerySource source = find_query(inputs, session);
  query.name = source.sequence.name;
  query.path = source.sequence.sequence.path.string();
  query.images = {source.sequence.sequence.path, source.sequence.sequence.range};
  query.words = describe_words(open_sequence(source.sequence.sequence), database, skip_unreadable,
                               session.monitor);
  return query;
}

// If nothing was recognized, the match with the highest probability.
std::string advice(const Result& result) {
  const Match* best = nullptr;
  for (const std::optional<Match>& match : result.best)
    if (match && (best == nullptr || match->score > best->score)) best = &*match;
  if (!result.recognitions.empty() || best == nullptr) return "";
  const auto& settings = std::get<FabmapQuerySettings>(result.settings);
  const std::string in_a_row =
      settings.window == 1 ? "" : fmt::format(" in {} consecutive frames", settings.window);
  return fmt::format(
      "Nothing is recognized: no probability is above t_p {}{}. The highest is {:.4f}, of {} in "
      "frame {}.\n",
      settings.place_threshold, in_a_row, best->score, result.places->names[best->train],
      best->query);
}

std::string summary(const Result& result) {
  const ResultPlaces& places = *result.places;
  std::set<uint32_t> recognized;
  for (const Match& recognition : result.recognitions) recognized.insert(recognition.train);
  Table table;
  table.title = fmt::format("{}: {}, {} of {} of {}", query_title(result),
                            counted(result.query.frames, "frame"),
                            counted(result.recognitions.size(), "recognition"), recognized.size(),
                            counted(places.names.size(), "place"));
  if (places.featureless > 0)
    table.title += fmt::format("; {} without features", counted(places.featureless, "frame"));
  table.columns = {"query frames", "places", "recognitions", "probability"};
  const auto stretch = [](const std::string& first, const std::string& last) {
    return first == last ? first : fmt::format("{} to {}", first, last);
  };
  const bool is_frame_a_place = places.names.size() == places.views;
  const std::vector<PlaceRun> runs = is_frame_a_place ? place_runs(result.recognitions, 2, 2)
                                                      : place_runs(result.recognitions, 1, 0);
  for (const PlaceRun& run : runs) {
    if (table.rows.size() == kTableRows) break;
    table.rows.push_back({stretch(std::to_string(run.first_frame), std::to_string(run.last_frame)),
                          stretch(places.names[run.first_place], places.names[run.last_place]),
                          std::to_string(run.recognitions),
                          fmt::format("{:.4f}", run.probability)});
  }
  std::string text = render_table(table, TableFormat::text);
  if (runs.size() > kTableRows) text += fmt::format("... and {} more\n", runs.size() - kTableRows);
  return text;
}

}  // namespace

void run_fabmap_query(Session& session, const QueryInputs& inputs,
                      const FabmapQuerySettings& settings) {
  const CommonOptions& options = session.options;
  if (!options.output.empty()) claim_result(options.output, session.outputs);
  if (inputs.explained_frame && !options.output.empty())
    session.outputs.claim_file(explanation_picture_path(options.output));
  if (!inputs.posteriors.empty()) session.outputs.claim_file(inputs.posteriors);
  if (!inputs.loop.list.empty()) session.outputs.claim_file(inputs.loop.list);
  const Stopwatch watch;
  const FabmapDatabase database = read_fabmap_database(inputs.database);
  const WordQuery query = read_query(inputs, database, settings.skip_unreadable, session);
  const double describe_s = watch.elapsed_s();
  const size_t frames = query.words.sequence.frames;
  images_by_group(inputs, database);  // a wrong name should not cost the whole query
  const auto explained = inputs.explained_frame;
  if (explained && *explained >= frames)
    throw Error(ErrorKind::usage, fmt::format("--explain {}: the query's frames are 0 to {}",
                                              *explained, frames - 1));
  std::optional<PosteriorFile> posteriors;
  if (!inputs.posteriors.empty())
    posteriors.emplace(session.outputs.file(inputs.posteriors), frames,
                       database.views.views() + (settings.loop ? frames : 0));
  std::vector<double> explained_posterior;
  const auto observe = [&](size_t frame, std::span<const double> posterior) {
    if (posteriors) posteriors->add(posterior);
    if (frame == explained) explained_posterior.assign(posterior.begin(), posterior.end());
  };
  FabmapRun run = query_fabmap(database, query.words, query.name, settings, options.seed, observe,
                               session.monitor);
  run.seconds["describe"] = describe_s;
  run.seconds["total"] = watch.elapsed_s();
  ResultContext context = context_of(session, inputs, query.path, run.seconds);
  context.database_fingerprint = database.fingerprint;
  context.query_fingerprint = words_fingerprint(query.words);
  std::string text = summary(run.result) + advice(run.result);
  if (explained) {
    const FabmapDatabase searched =
        settings.loop ? with_query(database, query.words, query.name) : database;
    const Explanation explanation = explain_frame(searched, query.words.words[*explained],
                                                  *explained, explained_posterior, settings);
    context.explanation = explanation_json(explanation);
    text += "\n" + explanation_text(explanation);
    if (query.images && !options.output.empty() && !explanation.places.empty()) {
      const Selection& selection = query.words.sequence.selection;
      const FrameOfQuery frame = {*query.images,
                                  selection.is_all() ? *explained : selection.sources[*explained]};
      write_explanation_picture(explanation, inputs, frame, searched, settings.loop, session);
      text += fmt::format("Drawn in {}\n", explanation_picture_path(options.output).string());
    }
  }
  if (posteriors) {
    context.files["posteriors"] = posteriors->entry(session.monitor);
    context.checksums[inputs.posteriors] = context.files["posteriors"]["checksum"];
  }
  write_loops(inputs, run.result, session);
  session.print_result(text, keep_result(session, run.result, context));
}

}  // namespace vpr
