// Queries of a FAB-MAP database.
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "chart/chart.h"
#include "decide/clustering.h"
#include "fabmap/explanation_report.h"
#include "fabmap/place_query.h"
#include "files/matrix_file.h"
#include "query.h"
#include "sequence/sequence.h"
#include "sequence/sequence_source.h"
#include "words/word_training.h"

namespace vpr {
namespace {

struct WordQuery {
  std::string name;
  std::string path;
  std::optional<SequenceArgument> images;  ///< as recorded; nullopt for a BOW matrix
  SequenceWords words;
};

WordQuery read_query(const QueryOptions& options, const FabmapDatabase& database,
                     bool skip_unreadable, const Session& session) {
  WordQuery query;
  if (!options.query_bow.empty()) {
    const SelectionSettings& selected_by = options.selection;
    refuse(options.query || !options.query_npy.empty() || !options.dataset.empty() ||
               selected_by.fps || selected_by.recorded_fps || !options.query_times.empty(),
           "--query-bow",
           "cannot be combined with --query, --query-npy, --dataset, --fps and frame rates");
    const SequenceArgument argument = parse_sequence_argument(options.query_bow);
    query.name = sequence_names({argument}).front();
    query.path = argument.path.string();
    SequenceWords rows{{}, read_openfabmap_frames(argument, database.tree.words())};
    rows.sequence.frames = rows.words.size();
    const Selection selection =
        at_speed(options.selection.speed, rows.sequence.frames, session.options.process.seed);
    query.words = selected(std::move(rows), selection);
    return query;
  }
  const NamedSequence source = find_query(options, false, session);
  query.name = source.name;
  query.path = source.sequence.path.string();
  query.images = {source.sequence.path, source.sequence.range};
  query.words =
      describe_words(open_sequence(source.sequence), database, skip_unreadable, session.monitor);
  return query;
}

// The training sequences of --train by group of the database. Groups of equal names are
// assigned in order. Throws Error(usage) for a name without a group.
std::map<size_t, SequenceArgument> images_by_group(const QueryOptions& options,
                                                   const FabmapDatabase& database) {
  std::map<size_t, SequenceArgument> images;
  for (const std::string& text : options.train_images) {
    // An existing path takes precedence over the name of a group.
    const bool is_path = std::filesystem::exists(parse_sequence_argument(text).path);
    const size_t equals = is_path ? std::string::npos : text.find('=');
    const SequenceArgument argument =
        parse_sequence_argument(equals == std::string::npos ? text : text.substr(equals + 1));
    const std::string name =
        equals == std::string::npos ? sequence_names({argument}).front() : text.substr(0, equals);
    size_t group = 0;
    while (group < database.groups.size() &&
           (database.groups[group].sequence.name != name || images.contains(group)))
      ++group;
    if (group == database.groups.size())
      throw Error(ErrorKind::usage,
                  "--train: the database has no further group named {}; vpr-train info lists them",
                  name);
    images[group] = argument;
  }
  return images;
}

// Draws the explained frame next to the views of its best places, with their words. `recorded`: the
// frame before selection. `images`: by group of the database; other views have no image.
void draw_explanation(const Explanation& explanation, const SequenceArgument& query,
                      size_t recorded, const FabmapDatabase& database,
                      const std::map<size_t, SequenceArgument>& images, const Session& session) {
  const MarkedImage frame = locate_words(open_sequence(query), recorded, database, session.monitor);
  std::vector<ImagePair> pairs;
  for (const PlaceExplanation& place : explanation.places) {
    ImagePair& pair = pairs.emplace_back();
    pair.query = mark_words(frame, place, fmt::format("query frame {}", explanation.frame));
    pair.view.title = fmt::format("{}, probability {:.4f}, log-odds {:+.2f}", place.place,
                                  place.match.score, place.log_odds);
    const ViewOrigin origin = database.origin(place.match.view);
    const auto source = images.find(origin.group);
    if (source == images.end()) {
      pair.view.title += " (its images: --train)";
      continue;
    }
    try {
      pair.view = mark_words(
          locate_words(open_sequence(source->second), origin.frame, database, session.monitor),
          place, pair.view.title);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      pair.view.title += " (can't be decoded)";
    }
  }
  session.outputs.file(companion_path(session.options.output, "explain.png"))
      .write(png_of(draw_word_pairs(pairs)));
}

// Explains a frame in the context of the result and in the plot of vpr-query explain; returns the
// text.
std::string explain(size_t frame, std::span<const double> posterior, const QueryOptions& options,
                    const FabmapDatabase& database, const WordQuery& query,
                    const FabmapQuerySettings& settings, ResultContext& context,
                    const Session& session) {
  const FabmapDatabase searched =
      settings.loop ? with_query(database, query.words, query.name) : database;
  const Explanation& explanation = context.explanation.emplace(
      explain_frame(searched, query.words.words[frame], frame, posterior, settings));
  const std::string text = "\n" + explanation_text(explanation);
  const std::string& output = session.options.output;
  if (!query.images || output.empty() || explanation.places.empty()) return text;
  std::map<size_t, SequenceArgument> images = images_by_group(options, searched);
  if (settings.loop) images[searched.groups.size() - 1] = *query.images;
  draw_explanation(explanation, *query.images, query.words.sequence.selection.source_of(frame),
                   searched, images, session);
  return text + fmt::format("Drawn in {}\n", companion_path(output, "explain.png").string());
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
  images_by_group(options, database);  // report a wrong name before the query
  const auto explained = options.explained_frame;
  if (explained && *explained >= frames)
    throw Error(ErrorKind::usage, "--frame {}: the query's frames are 0 to {}", *explained,
                frames - 1);
  std::optional<PosteriorFile> posteriors;
  if (!options.posteriors.empty())
    posteriors.emplace(session.outputs.file(options.posteriors), frames,
                       database.views.views() + (settings.loop ? frames : 0));
  std::vector<double> explained_posterior;
  const auto observe = [&](size_t frame, std::span<const double> posterior) {
    if (posteriors) posteriors->add(posterior);
    if (frame == explained) explained_posterior.assign(posterior.begin(), posterior.end());
  };
  QueryRun run = query_fabmap(database, query.words, query.name, settings,
                              session.options.process.seed, observe, session.monitor);
  ResultContext context = make_context(options, session);
  if (query.images)
    set_query_path(context.run, *query.images);
  else
    context.run.paths["query"] = query.path;
  context.seconds = std::move(run.seconds);
  context.seconds["describe"] = describe_s;
  context.seconds["total"] = watch.elapsed_s();
  context.database_fingerprint = database.fingerprint;
  context.query_fingerprint = words_fingerprint(query.words);
  std::string text = summary_text(run.result, options, session) + advice(run.result);
  if (explained)
    text += explain(*explained, explained_posterior, options, database, query, settings, context,
                    session);
  if (posteriors) {
    context.files["posteriors"] = posteriors->entry(session.monitor);
    context.checksums[options.posteriors] = context.files["posteriors"].checksum;
  }
  save_loops(options, run.result, session);
  session.print_result(text, save_result(session, run.result, context));
}

}  // namespace vpr
