#include "fabmap/place_query.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"

namespace vpr {

namespace {

constexpr uint32_t kPlaces = in(QueryCommand::query, QueryCommand::loops);

constexpr std::array kFabmapRows = {
    SettingRow{.key = "t_p",
               .group = kFabmapGroup,
               .commands = kPlaces,
               .help = "probability threshold t_p of a recognition (default: {})"},
    SettingRow{.key = "c_w",
               .group = kFabmapGroup,
               .commands = kPlaces,
               .help = "consecutive frames c_w that must exceed t_p (default: {})"},
    SettingRow{.key = "variant",
               .group = kFabmapGroup,
               .commands = kPlaces,
               .help = "computation of likelihoods (default: {})",
               .value = "VARIANT",
               .choices = [] { return names_of(fabmap_variants()); }},
    SettingRow{.key = "word_model",
               .group = kFabmapGroup,
               .commands = kPlaces,
               .help = "dependencies of words (default: {})"},
    SettingRow{.key = "new_place",
               .group = kFabmapGroup,
               .commands = kPlaces,
               .help = "likelihood of a new place: average over the pretraining frames, or mean "
                       "field (default: {})"},
    SettingRow{.key = "new_place_samples",
               .group = kFabmapGroup,
               .commands = kPlaces,
               .help = "random pretraining frames for it; 0: all (default: {})"},
};

constexpr size_t kPosteriorsAtOnce = size_t{1} << 25;  // values in memory at the same time
constexpr size_t kMostFramesAtOnce = 64;

Match likeliest_view(size_t frame, std::span<const double> posterior,
                     const std::vector<uint32_t>& place_of) {
  const auto best = std::max_element(posterior.begin() + 1, posterior.end());
  const auto view = static_cast<uint32_t>(best - posterior.begin() - 1);
  return {static_cast<uint32_t>(frame), 0, place_of[view], view, *best};
}

// The database of a query with `loop`: every query frame is a place, after those of `database`.
FabmapDatabase with_query(const FabmapDatabase& database, const SequenceWords& query,
                          const std::string& query_name) {
  FabmapDatabase extended = database;
  ViewGroup group{query.sequence};
  group.sequence.name = query_name;
  group.sequence.frame_names.resize(query.sequence.frames);
  add_group(extended, group, query.words);
  index_views(extended);
  return extended;
}

// The number of views that a frame may match: with `loop`, query frames before the gap only.
size_t known_views(const FabmapDatabase& searched, size_t query_frames, size_t frame,
                   const FabmapQuerySettings& settings) {
  if (!settings.loop) return searched.views.views();
  const size_t from_database = searched.views.views() - query_frames;
  return from_database + settings.searched_before(frame);
}

// Initializes the probability of new views for the motion model.
void extend_previous(std::vector<double>& previous, size_t views, double smoothing) {
  if (previous.empty() || previous.size() == views + 1) return;
  previous.resize(views + 1, (1 - smoothing) / static_cast<double>(views + 1));
}

// The result before the first frame.
Result make_result(const FabmapDatabase& searched, const SequenceWords& query,
                   const std::string& query_name, const FabmapQuerySettings& settings) {
  Result result;
  result.settings = settings;
  result.query = query.sequence;
  result.query.name = query_name;
  result.query_windows = query.sequence.frames;
  ResultPlaces& places = result.places.emplace();
  places.names = searched.place_names();
  places.views = searched.places().size();
  places.featureless = featureless_frames(query);
  ComparedSequence& compared = result.sequences.emplace_back();
  compared.sequence = {"places", places.names.size()};
  compared.windows = places.names.size();
  for (size_t frame = 0; settings.loop && frame < result.query.frames; ++frame)
    result.past.push_back(
        static_cast<uint32_t>(first_own_place(result) + settings.searched_before(frame)));
  return result;
}

std::vector<uint32_t> places_of(const FabmapDatabase& searched) {
  std::vector<uint32_t> place_of = searched.places();
  if (place_of.empty())
    throw Error(ErrorKind::usage,
                "the database has no places. Train some, or use vpr-query loops to recognize "
                "places of the query.");
  return place_of;
}

// The pretraining frames whose average likelihood is the likelihood of the new place.
ViewWords new_place_views(const FabmapDatabase& database, const FabmapQuerySettings& settings,
                          uint64_t seed) {
  const size_t all = database.pretrain.views();
  if (settings.new_place_samples == 0 || settings.new_place_samples >= all)
    return database.pretrain;
  std::vector<size_t> order(all);
  std::iota(order.begin(), order.end(), size_t{0});
  RandomEngine engine(seed);
  for (size_t i = 0; i < settings.new_place_samples; ++i)
    std::swap(order[i], order[i + uniform_below(engine, all - i)]);
  ViewWords sample;
  for (size_t i = 0; i < settings.new_place_samples; ++i)
    sample.add(database.pretrain.view(order[i]));
  return sample;
}

/// Adds the frames of a query to its result, in order, because the motion model starts from the
/// previous posterior.
class PlaceTracker {
 public:
  PlaceTracker(const SequenceWords& query, const FabmapQuerySettings& settings,
               const std::vector<uint32_t>& place_of, const PosteriorObserver& observe,
               Result& result)
      : query_(query),
        settings_(settings),
        place_of_(place_of),
        observe_(observe),
        result_(result) {}

  /// `views`, `new_place`: log likelihoods.
  void add(size_t frame, std::span<const double> views, double new_place) {
    const bool unreadable = std::ranges::binary_search(query_.sequence.unreadable, frame);
    std::vector<double> posterior;
    if (!unreadable) {
      extend_previous(previous_, views.size(), settings_.posterior.smoothing);
      posterior = fabmap_posterior(views, new_place, previous_, settings_.posterior);
    }
    // A frame without words resembles every view without words. Its posterior goes to files and to
    // the motion model, but recognizes nothing.
    const std::span<const double> shown =
        query_.words[frame].empty() ? std::span<const double>{} : posterior;
    if (observe_) observe_(frame, posterior);
    window_.add(shown, settings_.place_threshold, views.size());
    result_.places->new_place.push_back(unreadable ? 0 : posterior[0]);
    result_.best.emplace_back();
    if (!shown.empty() && !views.empty()) {
      const Match best = likeliest_view(frame, posterior, place_of_);
      if (std::isfinite(views[best.view])) result_.best.back() = best;
    }
    append_recognitions(result_.recognitions, frame, shown, window_, settings_.window, place_of_);
    if (!unreadable) previous_ = std::move(posterior);
  }

 private:
  const SequenceWords& query_;
  const FabmapQuerySettings& settings_;
  const std::vector<uint32_t>& place_of_;
  const PosteriorObserver& observe_;
  Result& result_;
  ViewWindow window_;
  std::vector<double> previous_;  // posterior
};

}  // namespace

std::span<const SettingRow> fabmap_setting_rows() { return kFabmapRows; }

void check_query_settings(const FabmapQuerySettings& settings) {
  require_range("t_p", settings.place_threshold, 0, 1);
  require_range("posterior.smoothing", settings.posterior.smoothing, 0, 1);
  require_range("posterior.motion_bias", settings.posterior.motion_bias, 0, 1);
  if (!(settings.posterior.new_place_prior > 0 && settings.posterior.new_place_prior <= 1))
    throw Error(ErrorKind::usage, "posterior.new_place_prior must be above 0 and at most 1");
  if (settings.window < 1 || settings.window > 1'000'000)
    throw Error(ErrorKind::usage, "c_w must be from 1 to 1000000, found {}", settings.window);
  require_range("lut_digits", static_cast<double>(settings.lut_digits), 1, 12);
  find_fabmap_variant(settings.variant);
}

void append_recognitions(std::vector<Match>& recognitions, size_t frame,
                         std::span<const double> posterior, const ViewWindow& window,
                         uint64_t window_length, const std::vector<uint32_t>& place_of) {
  std::map<uint32_t, Match> found;
  for (uint32_t view = 0; view + 1 < posterior.size(); ++view) {
    if (window.run[view] < window_length) continue;
    const Match match{static_cast<uint32_t>(frame), 0, place_of[view], view, posterior[view + 1]};
    const auto [entry, is_new] = found.emplace(match.train, match);
    if (!is_new && match.score > entry->second.score) entry->second = match;
  }
  for (const auto& [place, match] : found) recognitions.push_back(match);
}

QueryRun query_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                      const std::string& query_name, const FabmapQuerySettings& settings,
                      uint64_t seed, const PosteriorObserver& observe, const Monitor& monitor) {
  check_query_settings(settings);
  if (settings.loop && !query.sequence.selection.is_all())
    throw Error(ErrorKind::usage,
                "vpr-query loops needs all frames of a query. For fewer frames, use a range with a "
                "step, as in PATH@::6.");
  std::optional<FabmapDatabase> extended;
  if (settings.loop) extended = with_query(database, query, query_name);
  const FabmapDatabase& searched = extended ? *extended : database;
  const std::vector<uint32_t> place_of = places_of(searched);
  const size_t frames = query.sequence.frames;
  QueryRun run{make_result(searched, query, query_name, settings), {}};
  Stopwatch watch;
  const FabmapMatcher matcher(searched, settings, seed);
  run.seconds["index"] = watch.elapsed_s();
  watch = {};
  StepCounter counter(monitor, "match", frames);
  PlaceTracker tracker(query, settings, place_of, observe, run.result);
  const size_t at_once =
      std::clamp(kPosteriorsAtOnce / place_of.size(), size_t{2}, kMostFramesAtOnce);
  for (size_t begin = 0; begin < frames; begin += at_once) {
    const size_t count = std::min(at_once, frames - begin);
    std::vector<std::vector<double>> views(count);
    std::vector<double> new_place(count);
    parallel_for(count, monitor, [&](size_t i) {
      const size_t frame = begin + i;
      views[i] = matcher.views(query.words[frame], known_views(searched, frames, frame, settings));
      new_place[i] = matcher.new_place(query.words[frame]);
      counter.add();
    });
    for (size_t i = 0; i < count; ++i) tracker.add(begin + i, views[i], new_place[i]);
  }
  run.seconds["match"] = watch.elapsed_s();
  return run;
}

FabmapMatcher::FabmapMatcher(const FabmapDatabase& db, const FabmapQuerySettings& s, uint64_t seed)
    : model(make_fabmap_model(db.tree, {s.p_seen_if_there, s.p_seen_if_not}, s.word_model)),
      index(make_fabmap_index(model, db.views, db.index)),
      samples(new_place_views(db, s, seed)),
      sample_lists(make_word_index(samples, model.words())),
      sample_index(make_fabmap_index(model, samples, sample_lists)),
      unreadable(db.unreadable_views()),
      database(db),
      settings(s) {}

std::vector<double> FabmapMatcher::views(const WordSet& words, size_t known_views) const {
  std::vector<double> logs =
      find_fabmap_variant(settings.variant)
          .log_likelihoods({model, database.views, index, words, known_views,
                            static_cast<int>(settings.lut_digits), unreadable});
  for (const size_t view : unreadable)
    if (view < logs.size()) logs[view] = -std::numeric_limits<double>::infinity();
  return logs;
}

double FabmapMatcher::new_place(const WordSet& words) const {
  if (settings.new_place == NewPlaceModel::mean_field) return new_place_mean_field(model, words);
  return log_mean_exp(
      fabmap2_log_likelihoods({model, samples, sample_index, words, samples.views()}));
}

}  // namespace vpr
