#include "run/fabmap_explain.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "sequence/frames.h"

namespace vpr {
namespace {

// The likeliest views of different places, best first.
std::vector<size_t> best_views(std::span<const double> posterior,
                               const std::vector<uint32_t>& place_of) {
  std::vector<size_t> order(posterior.size() - 1);
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return posterior[a + 1] > posterior[b + 1]; });
  std::vector<size_t> best;
  for (const size_t view : order) {
    if (best.size() == kExplainedPlaces) break;
    if (std::none_of(best.begin(), best.end(),
                     [&](size_t v) { return place_of[v] == place_of[view]; }))
      best.push_back(view);
  }
  return best;
}

std::string view_name(const FabmapDatabase& database, size_t view) {
  const ViewOrigin origin = database.origin(view);
  const Sequence& sequence = database.groups[origin.group].sequence;
  const std::string& name = sequence.frame_names[origin.frame];
  return fmt::format("{}: {}", sequence.name,
                     name.empty() ? fmt::format("#{}", origin.frame) : name);
}

}  // namespace

Explanation explain_frame(const FabmapDatabase& searched, const WordSet& words, size_t frame,
                          std::span<const double> posterior, const FabmapQuerySettings& settings) {
  Explanation explanation{frame, 0, {}};
  if (posterior.empty()) return explanation;
  explanation.new_place = posterior[0];
  const FabmapModel model = make_fabmap_model(
      searched.tree, {settings.p_seen_if_there, settings.p_seen_if_not}, settings.word_model);
  const std::vector<uint32_t> place_of = searched.places();
  const std::vector<std::string> names = searched.place_names();
  for (const size_t view : best_views(posterior, place_of)) {
    PlaceExplanation& place = explanation.places.emplace_back();
    place.match = {static_cast<uint32_t>(frame), 0, place_of[view], static_cast<uint32_t>(view),
                   posterior[view + 1]};
    place.place = names[place_of[view]];
    place.view = view_name(searched, view);
    const std::vector<WordEvidence> evidence =
        word_evidence(model, words, searched.views.view(view));
    for (const WordEvidence& word : evidence) {
      place.log_odds += word.log_odds;
      if (word.log_odds > 0 && place.for_it.size() < kExplainedWords) place.for_it.push_back(word);
    }
    for (auto word = evidence.rbegin(); word != evidence.rend(); ++word)
      if (word->log_odds < 0 && place.against.size() < kExplainedWords)
        place.against.push_back(*word);
  }
  return explanation;
}

FrameFeatures locate_words(const SequenceSource& sequence, size_t frame,
                           const FabmapDatabase& database, const Monitor& monitor) {
  FrameFeatures features;
  if (!sequence.files.empty()) {
    if (frame < sequence.files.size())
      features.gray = decode_image(sequence.files[frame], PixelFormat::gray);
  } else {
    for_each_frame(sequence, PixelFormat::gray, Unreadable::skip, monitor,
                   [&](size_t index, const cv::Mat& image) {
                     if (index == frame) features.gray = image.clone();
                   });
  }
  if (features.gray.empty())
    throw Error(ErrorKind::input, fmt::format("{}: has no readable frame {}",
                                              sequence.argument.path.string(), frame));
  const LocalFeatures found = find_features(features.gray, database.settings.features);
  features.points = found.points;
  features.words = nearest_words(make_vocabulary(database.vocabulary), found.descriptors);
  return features;
}

}  // namespace vpr
