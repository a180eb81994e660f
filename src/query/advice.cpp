#include "query/advice.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "query/prepare.h"
#include "query/train_sequences.h"
#include "recordings/sequence_source.h"

namespace vpr {

namespace {

constexpr size_t kFewest = 4;        // one recognized frame in four tells the cause
constexpr double kEnough = 2.0 / 3;  // share of recognized frames that needs no advice
constexpr double kAlmostAll = 0.9;   // the same of a dense query
constexpr double kDense = 0.75;      // share of keyframes of a dense query, at most
constexpr size_t kSlowStart = 4;     // paths of keyframes before the first decision, at most

// The mean speed of the longest path, in time if the rates of both sequences are known; nullopt
// without a path of several frames.
std::optional<double> recognized_speed(const Result& result) {
  const auto length = [](const Cluster& path) { return path.query_last - path.query_first; };
  const auto longest = std::ranges::max_element(result.clusters->all, {}, length);
  if (longest == result.clusters->all.end()) return std::nullopt;
  const auto rate = mean_rate(*longest);
  const auto& train_fps = result.sequences[longest->sequence].sequence.fps;
  if (!rate || !train_fps || !result.query.fps) return rate;
  return *rate * *result.query.fps / *train_fps;
}

// The result of default_filter.
Result filtered(const SequenceDatabase& database, const DescriptorSet& query,
                const SequenceQuerySettings& settings, const QueryResources& resources,
                const Monitor& monitor) {
  const Monitor unwarned = {monitor.progress, {}, monitor.stop};
  const SequenceQuerySettings filter = default_filter(settings);
  const PreparedDatabase prepared = prepare(database, filter, resources, unwarned);
  return run_query(plan_query(prepared, query, "", filter, resources, unwarned), {}, unwarned)
      .result;
}

// The database with every `step`-th training frame, and what is known of these frames. It has no
// distances between training frames to compute.
SequenceDatabase thinned(const SequenceDatabase& database, size_t step, const Monitor& monitor) {
  SequenceDatabase thin;
  thin.descriptor = database.descriptor;
  thin.descriptors.kind = database.descriptors.kind;
  thin.descriptors.unit = database.descriptors.unit;
  const std::vector<DescribedFrames> spans = descriptor_spans(database);
  std::vector<size_t> kept;  // frames of `database`
  size_t first = 0;
  for (size_t s = 0; s < spans.size(); ++s) {
    TrainSequence& train = thin.sequences.emplace_back();
    Sequence& sequence = train.sequence;
    sequence.name = database.sequences[s].sequence.name;
    train.typical_distance = database.sequences[s].typical_distance;
    if (const auto& radius = database.sequences[s].exclusion_radius)
      train.exclusion_radius = divide_up(*radius, step);
    const std::vector<size_t>& unreadable = database.sequences[s].sequence.unreadable;
    for (size_t frame = 0; frame < spans[s].rows.size(); frame += step) {
      thin.descriptors.append(spans[s].rows.subspan(frame, 1));
      kept.push_back(first + frame);
      if (std::ranges::binary_search(unreadable, frame))
        sequence.unreadable.push_back(sequence.frames);
      ++sequence.frames;
    }
    first += spans[s].rows.size();
  }
  // The last kept frame up to a frame, which is of the same keyframe or the one before.
  const auto number = [&](size_t frame) {
    return static_cast<size_t>(std::ranges::upper_bound(kept, frame) - kept.begin()) - 1;
  };
  thin.overlapping_sequences = database.overlapping_sequences;
  if (database.statistics) {
    TrainStatistics& statistics = thin.statistics.emplace();
    statistics.settings = database.statistics->settings;
    statistics.typical_distance = database.statistics->typical_distance;
    statistics.code_distance = database.statistics->code_distance;
    for (const size_t frame : kept) {
      statistics.bias.push_back(database.statistics->bias[frame]);
      statistics.variance.push_back(database.statistics->variance[frame]);
    }
    if (database.statistics->components) {
      TrainComponents& components = statistics.components.emplace(*database.statistics->components);
      for (size_t& landmark : components.landmarks) landmark = number(landmark);
      for (std::vector<int8_t>& loadings : components.loadings) {
        for (size_t k = 0; k < kept.size(); ++k) loadings[k] = loadings[kept[k]];
        loadings.resize(kept.size());
      }
    }
  }
  if (database.repeated_places) {
    std::vector<RepeatedPlace>& places = thin.repeated_places.emplace();
    for (const auto& [frame, first_pass] : *database.repeated_places) {
      const RepeatedPlace place{static_cast<uint32_t>(number(frame)),
                                static_cast<uint32_t>(number(first_pass))};
      const bool is_new = places.empty() || places.back().frame < place.frame;
      if (is_new && place.first_pass < place.frame) places.push_back(place);
    }
  }
  ensure_statistics(thin, monitor);
  return thin;
}

// "15 of 56 frames".
std::string recognized_text(const Result& result) {
  return fmt::format("{} of {}", recognized_windows(result), counted(result.query.frames, "frame"));
}

// The share of query frames that are recognized.
double recognized_share(const Result& result) {
  return static_cast<double>(recognized_windows(result)) /
         static_cast<double>(std::max<size_t>(result.query.frames, 1));
}

// The step of the range of a sequence, or 1.
size_t step_of(const std::string& path) {
  return path.empty() ? 1 : parse_sequence_argument(path).range.step;
}

// Frames of both sides, by their steps.
struct Steps {
  size_t query_step = 1;
  size_t train_step = 1;
};

// The advice to use these steps. `recognized`: the frames that are then recognized, in words.
// `images`: the query, or null.
std::string selection_text(const Steps& steps, const std::string& recognized,
                           const SequenceDatabase& database, const DescriptorSet& query,
                           const SequenceArgument* images) {
  const size_t step = std::max(steps.query_step, steps.train_step);
  const std::string ordinal = step == 2   ? "second"
                              : step == 3 ? "third"
                              : step == 4 ? "fourth"
                              : step == 6 ? "sixth"
                                          : "tenth";
  const size_t trained_step = step * step_of(database.sequences.front().path);
  if (steps.query_step == steps.train_step)
    return fmt::format(
        "With every {} frame of both sides, {} are recognized: the frames between them say "
        "little new. Train with PATH@::{}, and query PATH@::{}.",
        ordinal, recognized, trained_step, step * (images == nullptr ? 1 : images->range.step));
  if (steps.train_step != 1)
    return fmt::format(
        "With every {} training frame, {} are recognized: the query is fast for the training "
        "sequence. Train with PATH@::{}.",
        ordinal, recognized, trained_step);
  return fmt::format(
      "With every {} query frame{}, {} are recognized: the query is slow for the training "
      "sequence, or the training sequence has too few frames per second.",
      ordinal, query.sequence.selection.speed.empty() ? fmt::format(" (--speed {})", step) : "",
      recognized);
}

// A sentence if clearly more frames are recognized with a selection of the frames of one side or of
// both, by the best selection; empty if not. As the filter follows half to twice the speed of the
// training sequence, a third and a tenth tell whether other selections are worth a try. If enough
// frames are recognized, tries only every third frame of both sides. `images`: the query, or null.
std::string selection_advice(const SequenceDatabase& database, const DescriptorSet& query,
                             const SequenceQuerySettings& settings, const Result& before,
                             const QueryResources& resources, const Monitor& monitor,
                             const SequenceArgument* images) {
  constexpr size_t kLargestOfOneSide = 3;
  const Monitor silent = {{}, {}, monitor.stop};
  Steps best;
  Result found = before;
  const auto improves = [&](const SequenceDatabase& trained, const DescriptorSet& frames,
                            const Steps& steps) {
    Result result = filtered(trained, frames, settings, resources, monitor);
    if (recognized_share(result) <= recognized_share(found)) return false;
    best = steps;
    found = std::move(result);
    return true;
  };
  const double share = recognized_share(before);
  const auto step_improves = [&](size_t step) {
    const DescriptorSet fewer =
        selected(query, at_speed(std::to_string(step), query.rows().size(), 1));
    const SequenceDatabase thin = thinned(database, step, silent);
    bool any = improves(thin, fewer, {step, step});
    if (step > kLargestOfOneSide || share >= kEnough) return any;
    any |= improves(database, fewer, {step, 1});
    any |= improves(thin, query, {1, step});
    return any;
  };
  const bool third = step_improves(3);
  if (share < kEnough) {
    const bool tenth = step_improves(10);
    if (third || tenth)
      for (const size_t step : {2, 4, 6}) step_improves(step);
  }
  // Half as many frames more, or half of the others.
  const double better = std::min(1.5 * share, (1 + share) / 2);
  if (recognized_share(found) < std::max(1.0 / kFewest, better)) return "";
  return selection_text(best, recognized_text(found), database, query, images);
}

// A sentence if a quarter of the frames is recognized with the middle of the images of one side;
// empty if not, and if the images are many, are descriptors, or have moved.
std::string crop_advice(const SequenceDatabase& database, const DescriptorSet& query,
                        const SequenceArgument& images, const SequenceQuerySettings& settings,
                        const QueryResources& resources, const Monitor& monitor) {
  constexpr double kCrop = 0.8;
  constexpr size_t kMost = 1000;  // frames to describe
  const DescriptorStore& store = database.descriptors;
  if (store.kind->is_imported || query.rows().size() > kMost) return "";
  const Monitor silent = {{}, {}, monitor.stop};
  const auto advice = [](const Result& found, std::string_view side, std::string_view other) {
    if (kFewest * recognized_windows(found) < found.query.frames) return std::string();
    return fmt::format(
        "With the middle {:g} % of the {} images, {} are recognized: they show more than the {} "
        "images. Crop them, or use the same lens and zoom.",
        100 * kCrop, side, recognized_text(found), other);
  };
  SequenceTrainSettings cropped;
  cropped.descriptor_kind = store.kind->name;
  cropped.descriptor = database.descriptor;
  cropped.descriptor.crop = kCrop;
  cropped.skip_unreadable = true;
  try {
    SequenceDatabase like;
    like.descriptor = cropped.descriptor;
    like.descriptors.kind = store.kind;
    like.descriptors.unit = store.unit;
    const DescriptorSet middle = describe_frames(open_sequence(images), like, true, silent);
    const std::string text =
        advice(filtered(database, middle, settings, resources, monitor), "query", "training");
    if (!text.empty() || store.rows().size() > kMost) return text;
    std::vector<NamedArgument> sequences;
    for (const TrainSequence& train : database.sequences)
      sequences.push_back({train.sequence.name, parse_sequence_argument(train.path)});
    const SequenceDatabase narrow = train_sequences(sequences, cropped, silent);
    return advice(filtered(narrow, query, settings, resources, monitor), "training", "query");
  } catch (const Error& error) {  // the images have moved
    if (error.kind() == ErrorKind::interrupted) throw;
    return "";
  }
}

}  // namespace

SequenceQuerySettings default_filter(const SequenceQuerySettings& settings) {
  Filter filter;
  filter.same_place = same_place_of(settings.rule);
  if (const auto* rule = std::get_if<Filter>(&settings.rule)) filter.witness = rule->witness;
  return {filter, settings.only_sequences, settings.skip_unreadable};
}

std::optional<std::string> excess_advice(const Result& result) {
  constexpr double kMostShare = 0.2;
  std::vector<uint64_t> counts(result.sequences.size());
  for (const Match& recognition : result.recognitions) ++counts[recognition.sequence];
  const auto queries = static_cast<double>(
      std::ranges::count_if(result.best, [](const auto& best) { return best.has_value(); }));
  double largest = 0;
  size_t worst = 0;
  size_t excesses = 0;
  for (size_t s = 0; s < counts.size(); ++s) {
    const auto windows = static_cast<double>(result.sequences[s].windows);
    const double share = static_cast<double>(counts[s]) / (windows * queries);
    if (!result.sequences[s].threshold || !(share > kMostShare)) continue;
    ++excesses;
    if (share > largest) worst = s;
    largest = std::max(largest, share);
  }
  if (excesses == 0) return std::nullopt;
  return fmt::format(
      "t_r accepts {:.0f} % of the window pairs of {}{}: too many to tell places apart",
      100 * largest, result.sequences[worst].sequence.name,
      excesses == 1
          ? ""
          : ", and more than a fifth of " + counted(excesses - 1, "other training sequence"));
}

std::string no_recognition_advice(const Result& result) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (std::ranges::none_of(result.best, [](const auto& best) { return best.has_value(); }))
    return "No window has a match: none has an earlier readable window beyond --gap.";
  if (decision_of(settings.rule) == Decision::threshold) {
    const bool has_threshold = std::ranges::any_of(
        result.sequences, [](const ComparedSequence& t) { return t.threshold.has_value(); });
    return has_threshold ? "Nothing is recognized: no score is below t_r."
                         : "Best matches only: a recognition needs --t-r, or --decide margin with "
                           "--margin.";
  }
  const bool has_margin =
      std::ranges::any_of(result.margins, [](const auto& margin) { return margin.has_value(); });
  return has_margin ? "Nothing is recognized: no best match has the margin."
                    : "Nothing is recognized: no training frame is outside the exclusion zone "
                      "(--exclusion-frames) of a best match. Use longer sequences.";
}

std::string filter_advice(const SequenceDatabase& database, const DescriptorSet& query,
                          const SequenceQuerySettings& settings, const QueryResources& resources,
                          const Monitor& monitor, const Result* known,
                          const SequenceArgument* images) {
  constexpr double kSameSpeed = 1.2;  // and its inverse
  const bool is_default =
      settings_in_force(settings) == settings_in_force(default_filter(settings));
  const bool is_known = known != nullptr && is_default;
  const Result forward =
      is_known ? *known : filtered(database, query, settings, resources, monitor);
  if (needs_advice(forward)) {
    const bool is_enough = recognized_share(forward) >= kEnough;
    const size_t keyframes = forward.keyframes ? forward.keyframes->query.size() : 0;
    size_t trained = 0;  // keyframes of the longest training sequence
    if (forward.keyframes)
      for (const auto& of_sequence : forward.keyframes->train)
        trained = std::max(trained, of_sequence.size());
    const uint64_t needed = FilterSettings{}.path_keyframes;
    if (!is_enough && std::min(keyframes, trained) < needed)
      return fmt::format(
          "The {} has {} (frames that differ clearly), and the filter needs a path of {}: "
          "record a longer walk.",
          keyframes < needed ? "query" : "training sequence",
          counted(std::min(keyframes, trained), "keyframe"), needed);
    const size_t frames = query.rows().size();
    const size_t reversed = *forward.path->reversed_frames;
    if (!is_enough && kFewest * reversed >= frames)
      return fmt::format(
          "The query walked in the opposite direction: with reversed training sequences, {} of {} "
          "are recognized. Train this direction in a database of its own.",
          reversed, counted(frames, "frame"));
    if (std::string text =
            selection_advice(database, query, settings, forward, resources, monitor, images);
        !text.empty())
      return text + (is_default ? "" : " This needs default settings (--method filter).");
    if (kFewest * recognized_windows(forward) < frames) {
      if (images != nullptr)
        if (std::string text = crop_advice(database, query, *images, settings, resources, monitor);
            !text.empty())
          return text;
      const size_t fewest = std::min(keyframes, trained);
      return fmt::format(
          "{} matches: not forward, not backward, not at half or twice the speed, not with fewer "
          "frames of both sides. {} may show another place{}.",
          forward.recognitions.empty() ? "Nothing" : "Nothing else",
          forward.recognitions.empty() ? "The query" : "The other frames",
          fewest < kSlowStart * needed
              ? fmt::format(
                    ", or the {} keyframes of the {} are too few: a decision needs up to {}",
                    fewest, keyframes <= trained ? "query" : "training sequence",
                    kSlowStart * needed)
              : "");
    }
    if (is_known) return "";
  }
  const auto speed = recognized_speed(forward);
  const bool is_same_speed = !speed || (*speed <= kSameSpeed && *speed >= 1 / kSameSpeed);
  return fmt::format("With default settings (--method filter, margin {:g}), {} are recognized{}.",
                     kFilterMargin, recognized_text(forward),
                     is_same_speed ? "" : fmt::format(", at about {:.1f} times the speed", *speed));
}

bool needs_advice(const Result& result) {
  if (!result.path) return result.recognitions.empty();
  const double share = recognized_share(result);
  if (share < kEnough || share >= kAlmostAll || !result.path->keyframes) return share < kEnough;
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  const bool is_default =
      settings_in_force(settings) == settings_in_force(default_filter(settings));
  return is_default && static_cast<double>(*result.path->keyframes) <=
                           kDense * static_cast<double>(result.query.frames);
}

}  // namespace vpr
