// Queries of a FAB-MAP database.
#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "fabmap/place_query.h"
#include "fabmap/word_training.h"
#include "query.h"
#include "query/clustering.h"
#include "query/matrix_file.h"
#include "recordings/sequence.h"
#include "recordings/sequence_source.h"

namespace vpr {
namespace {

struct WordQuery {
  std::string name;
  SequenceArgument recorded;  ///< frames before selection, or a BOW matrix
  SequenceWords words;
  bool is_bow = false;
};

WordQuery read_query(const QueryOptions& options, const FabmapDatabase& database,
                     bool skip_unreadable, const Session& session) {
  const NamedSequence named = find_query(options, session);
  const SequenceSource source = open_sequence(named.sequence);
  WordQuery query{named.name, {named.sequence.path, named.sequence.range}, {}, false};
  if (source.kind != SequenceKind::descriptors) {
    query.words = describe_words(source, database, skip_unreadable, session.monitor);
    return query;
  }
  refuse(options.selection.fps || options.selection.recorded_fps, "--fps",
         "is for frames, but the query has rows of words");
  query.is_bow = true;
  SequenceWords rows{{}, read_openfabmap_frames(query.recorded, database.tree.words())};
  rows.sequence.frames = rows.words.size();
  const Selection selection =
      at_speed(named.sequence.speed, rows.sequence.frames, named.sequence.seed);
  query.words = selected(std::move(rows), selection);
  return query;
}

// The match with the highest probability if there is no recognition.
std::string advice(const Result& result) {
  const Match* best = nullptr;
  for (const std::optional<Match>& match : result.best)
    if (match && (best == nullptr || match->score > best->score)) best = &*match;
  if (!result.recognitions.empty() || best == nullptr) return "";
  const auto& settings = std::get<FabmapQuerySettings>(result.settings);
  const std::string consecutive =
      settings.window == 1 ? "" : fmt::format(" in {} consecutive frames", settings.window);
  return fmt::format(
      "Nothing is recognized: no probability is above t_p {}{}. The highest is {:.4f}, for {} in "
      "frame {}.\n",
      settings.place_threshold, consecutive, best->score, result.places->names[best->train],
      best->query);
}

}  // namespace

void query_places(Session& session, const QueryOptions& options,
                  const FabmapQuerySettings& settings) {
  claim_outputs(options, session);
  const Stopwatch watch;
  const FabmapDatabase database = read_fabmap_database(options.database);
  const WordQuery query = read_query(options, database, settings.skip_unreadable, session);
  const double describe_s = watch.elapsed_s();
  const size_t frames = query.words.sequence.frames;
  std::optional<PosteriorFile> posteriors;
  if (!options.posteriors.empty())
    posteriors.emplace(session.outputs.file(options.posteriors), frames,
                       database.views.views() + (settings.loop ? frames : 0));
  const auto observe = [&](size_t, std::span<const double> posterior) {
    if (posteriors) posteriors->add(posterior);
  };
  QueryRun run = query_fabmap(database, query.words, query.name, settings,
                              session.options.process.seed, observe, session.monitor);
  ResultContext context = make_context(options, session);
  if (query.is_bow)
    context.run.paths["query"] = query.recorded.path.string();
  else
    set_query_path(context.run, query.recorded);
  context.seconds = std::move(run.seconds);
  context.seconds["describe"] = describe_s;
  context.seconds["total"] = watch.elapsed_s();
  context.database_fingerprint = database.fingerprint;
  context.query_fingerprint = words_fingerprint(query.words);
  const std::string text = summary_text(run.result, options, session) + advice(run.result);
  if (posteriors) {
    context.files["posteriors"] = posteriors->entry(session.monitor);
    context.checksums[options.posteriors] = context.files["posteriors"].checksum;
  }
  save_loops(options, run.result, session);
  session.print_result(text, save_result(session, run.result, context));
}

}  // namespace vpr
