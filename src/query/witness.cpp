#include "query/witness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/exponentials.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"

namespace vpr {
namespace {

// Matches of features.
constexpr double kRatio = 0.8;
constexpr double kTolerance = 8;     // pixels
constexpr double kMostTurn = 0.364;  // tangent of 20 degrees
constexpr double kLeastBase = 20;    // pixels between the features of a hypothesis
constexpr size_t kHypotheses = 300;

// Contrast.
constexpr size_t kLeastFeatures = 20;  // of a tested frame
constexpr double kChance = 4;          // inliers
constexpr size_t kOtherPlaces = 6;
constexpr size_t kOtherPlace = 10;  // keyframes between different places

// Evidence. The bonus stays below the default margin: features alone recognize nothing.
constexpr size_t kLeastTests = 8;
constexpr size_t kMostTests = 12;
constexpr size_t kLaterTests = 4;  // chosen frames per test after that many
constexpr double kClearContrast = 1.2;
constexpr double kBonus = 36;  // deviations of the margin per contrast
constexpr double kMostBonus = 9;
constexpr double kMostPenalty = 14;
constexpr double kLeastExpected = 0.5;  // of a witness that can see
constexpr double kPresent = 0.75;       // contrast per expected contrast without a penalty
constexpr double kAbsent = 0.55;        // with the most penalty

constexpr double kChange = 0.4;  // between frames with features, in typical distances

using Point = std::complex<double>;  // pixels

Point point_of(const LocalFeature& feature) { return {feature.x, feature.y}; }

// A reduction that compilers vectorize, unlike std::min_element.
template <class Iterator>
uint16_t least_of(Iterator first, Iterator last) {
  uint16_t least = std::numeric_limits<uint16_t>::max();
  for (; first != last; ++first) least = std::min(least, *first);
  return least;
}

// Pairs of features whose distance is clearly the smallest, in the order of training features.
std::vector<PointPair> distinct_pairs(std::span<const LocalFeature> query,
                                      std::span<const LocalFeature> train) {
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  const DescribedFrames trained{bits_of(train), {}};
  const FrameDistances distances = frame_distances({&trained, 1}, {bits_of(query), {}});
  std::vector<uint16_t> row(round_up(train.size(), kBlockFrames));
  std::vector<uint32_t> best(train.size(), kNone);  // query feature of each training feature
  std::vector<uint16_t> least(train.size());
  for (uint32_t q = 0; q < query.size(); ++q) {
    distances.tile({&q, 1}, 0, train.size(), row.data(), 0);
    const auto end = row.begin() + static_cast<ptrdiff_t>(train.size());
    const uint16_t first = least_of(row.begin(), end);
    const auto nearest = static_cast<size_t>(std::find(row.begin(), end, first) - row.begin());
    row[nearest] = std::numeric_limits<uint16_t>::max();
    const uint16_t second = least_of(row.begin(), end);
    if (!(first < kRatio * second)) continue;
    if (best[nearest] != kNone && least[nearest] <= first) continue;
    best[nearest] = q;
    least[nearest] = first;
  }
  std::vector<PointPair> pairs;
  for (size_t t = 0; t < train.size(); ++t)
    if (best[t] != kNone) pairs.push_back({point_of(query[best[t]]), point_of(train[t])});
  return pairs;
}

// The similarity transform of two pairs.
struct Transform {
  PointPair origin;
  Point factor;  // rotation and scale

  bool fits(const PointPair& pair) const {
    const Point error = factor * (pair.query - origin.query) - (pair.train - origin.train);
    return std::norm(error) < kTolerance * kTolerance;
  }
};

// Nullopt if it is implausible.
std::optional<Transform> transform_of(const PointPair& a, const PointPair& b) {
  const Point from = b.query - a.query;
  const Point to = b.train - a.train;
  if (std::min(std::norm(from), std::norm(to)) < kLeastBase * kLeastBase) return std::nullopt;
  const Point factor = to / from;
  if (std::norm(factor) < 0.25 || std::norm(factor) > 4) return std::nullopt;
  if (!(std::abs(factor.imag()) <= kMostTurn * factor.real())) return std::nullopt;
  return Transform{a, factor};
}

}  // namespace

std::vector<PointPair> inliers(std::span<const LocalFeature> query,
                               std::span<const LocalFeature> train) {
  if (query.size() < 2 || train.size() < 2) return {};
  std::vector<PointPair> pairs = distinct_pairs(query, train);
  const size_t count = pairs.size();
  std::optional<Transform> best;
  ptrdiff_t most = 1;
  size_t hypotheses = 0;
  for (size_t step = 1; step < count && hypotheses < kHypotheses; ++step)
    for (size_t i = 0; i + step < count && hypotheses < kHypotheses; ++i, ++hypotheses)
      if (const auto transform = transform_of(pairs[i], pairs[i + step])) {
        const auto fits = [&](const PointPair& pair) { return transform->fits(pair); };
        const ptrdiff_t fitting = std::ranges::count_if(pairs, fits);
        if (fitting <= most) continue;
        most = fitting;
        best = transform;
      }
  if (best)
    std::erase_if(pairs, [&](const PointPair& pair) { return !best->fits(pair); });
  else
    pairs.resize(std::min<size_t>(count, 1));
  return pairs;
}

TrainWitness::TrainWitness(const PreparedDatabase& prepared)
    : features_(&*prepared.database->features), train_(prepared.train) {
  if (prepared.exclusion_zones) overlapping_ = prepared.exclusion_zones->overlaps;
  size_t first = 0;
  for (const DescribedFrames& sequence : train_) {
    sequence_starts_.push_back(first);
    first += sequence.rows.size();
  }
  const std::vector<uint32_t>& frames = features_->frames;
  for (size_t k = 0; k < frames.size(); ++k) {
    const auto sequence = std::ranges::upper_bound(sequence_starts_, frames[k]);
    sequences_.push_back(static_cast<size_t>(sequence - sequence_starts_.begin()) - 1);
    // Repeated places are keyframes: one since the last frame with features stands for this one.
    const auto after =
        std::ranges::upper_bound(prepared.passes, frames[k], {}, &RepeatedPlace::frame);
    const bool is_repeated =
        after != prepared.passes.begin() && (k == 0 || std::prev(after)->frame > frames[k - 1]);
    const size_t first_pass = is_repeated ? std::prev(after)->first_pass : frames[k];
    const auto own = std::ranges::upper_bound(frames, first_pass) - frames.begin();
    first_passes_.push_back(static_cast<size_t>(std::max<ptrdiff_t>(own, 1)) - 1);
  }
}

DescriptorRow TrainWitness::row(size_t keyframe) const {
  const size_t sequence = sequences_[keyframe];
  return train_[sequence].rows[features_->frames[keyframe] - sequence_starts_[sequence]];
}

// Keyframes that show other places than `keyframe`, spread over the training sequences.
std::vector<size_t> TrainWitness::other_places(size_t keyframe, size_t number) const {
  const size_t count = sequences_.size();
  const auto is_other = [&](size_t other) {
    const size_t a = sequences_[keyframe];
    const size_t b = sequences_[other];
    if (a != b) return overlapping_.empty() || overlapping_[a][b] == 0;
    const auto [low, high] = std::minmax(first_passes_[keyframe], first_passes_[other]);
    const auto [before, after] = std::minmax(keyframe, other);
    return high - low > kOtherPlace && after - before > kOtherPlace;
  };
  std::vector<size_t> others;
  for (size_t i = 0; i < kOtherPlaces; ++i) {
    // The golden ratio spreads the places of consecutive frames.
    const double part = std::fmod(0.618033988749895 * static_cast<double>(number) +
                                      static_cast<double>(i) / static_cast<double>(kOtherPlaces),
                                  1.0);
    const auto start = static_cast<size_t>(part * static_cast<double>(count));
    for (size_t step = 0; step < count; ++step)
      if (const size_t other = (start + step) % count; is_other(other)) {
        others.push_back(other);
        break;
      }
  }
  return others;
}

// The contrast of features to keyframes [first, last).
std::optional<double> TrainWitness::contrast_to(std::span<const LocalFeature> query, size_t first,
                                                size_t last, size_t keyframe, size_t number) const {
  if (query.size() < kLeastFeatures) return std::nullopt;
  const std::vector<size_t> others = other_places(keyframe, number);
  if (others.empty()) return std::nullopt;
  size_t match = 0;
  for (size_t k = first; k < last; ++k)
    match = std::max(match, inliers(query, features_->of(k)).size());
  size_t other = 0;
  for (const size_t k : others) other = std::max(other, inliers(query, features_->of(k)).size());
  return natural_logarithm((static_cast<double>(match) + kChance) /
                           (static_cast<double>(other) + kChance));
}

// The keyframe at or before a match, or the first one of its sequence, which must have one.
size_t TrainWitness::keyframe_of(const Cell& match) const {
  const size_t until =
      features_->count_until(sequence_starts_[match.sequence] + match.train_window);
  const auto first = std::ranges::lower_bound(sequences_, match.sequence) - sequences_.begin();
  return std::max(until, static_cast<size_t>(first) + 1) - 1;
}

std::optional<double> TrainWitness::contrast(std::span<const LocalFeature> features,
                                             const Cell& match) const {
  const auto [first, last] =
      std::equal_range(sequences_.begin(), sequences_.end(), size_t{match.sequence});
  if (first == last) return std::nullopt;
  const size_t keyframe = keyframe_of(match);
  const auto begin = static_cast<size_t>(first - sequences_.begin());
  const auto end = static_cast<size_t>(last - sequences_.begin());
  return contrast_to(features, std::max(keyframe, begin + 1) - 1, std::min(keyframe + 2, end),
                     keyframe, match.query_window);
}

double TrainWitness::expected_contrast(DescriptorRow query, const Cell& match) const {
  const DescriptorRows& rows = train_[match.sequence].rows;
  const DistanceKind& distance = distance_of(rows.shape.element);
  const uint32_t change = distance.pair(query, rows[match.train_window]);
  const size_t keyframe = keyframe_of(match);
  const auto is_as_different = [&](size_t other) {
    return other < sequences_.size() && sequences_[other] == match.sequence &&
           distance.pair(row(keyframe), row(other)) >= change;
  };
  for (const int direction : {1, -1})
    for (size_t step = 1; step <= kOtherPlace; ++step) {
      const size_t other = direction > 0 ? keyframe + step : keyframe - step;
      if (is_as_different(other))
        return contrast_to(features_->of(keyframe), other, other + 1, keyframe, match.query_window)
            .value_or(0);
    }
  return 0;
}

int64_t evidence_margin(double contrast, double expected) {
  const double bonus = std::clamp(kBonus * (contrast - kClearContrast), 0.0, kMostBonus);
  const double absence =
      expected < kLeastExpected
          ? 0
          : std::clamp((kPresent - contrast / expected) / (kPresent - kAbsent), 0.0, 1.0);
  return std::llround((bonus - kMostPenalty * absence) * kScoreUnit);
}

// Compares the frames that were not compared yet, and drops those that cannot be.
void WitnessStage::run_tests() {
  std::erase_if(frames_, [&](Frame& frame) {
    if (frame.contrast) return false;
    frame.contrast = train_->contrast(frame.features(), frame.match);
    frame.features = nullptr;
    if (frame.contrast) ++tests_;
    return !frame.contrast;
  });
}

std::optional<double> WitnessStage::add_evidence(PathReport& report, DescriptorRow query,
                                                 const FeaturesOfFrame& features) {
  if (report.path != path_) {
    frames_.clear();
    tests_ = 0;
    path_ = report.path;
  }
  // A path that has been tested is tested less often.
  if (choose_(query) && (tests_ < kMostTests || ++omitted_ == kLaterTests)) {
    omitted_ = 0;
    frames_.push_back({report.matches.back(), {query.begin(), query.end()}, features, {}, {}});
    if (frames_.size() > kMostTests) frames_.pop_front();
  }
  const double margin = report.margin / double{kScoreUnit};
  const double least = least_margin_ / double{kScoreUnit};
  if (report.margin == 0 || margin + kMostBonus < least || margin - kMostPenalty >= least)
    return std::nullopt;
  run_tests();
  if (frames_.size() < kLeastTests) return std::nullopt;
  const auto count = static_cast<double>(frames_.size());
  double contrast = 0;
  for (const Frame& frame : frames_) contrast += *frame.contrast / count;
  double expected = 0;
  if (contrast < kClearContrast)
    for (Frame& frame : frames_) {
      if (!frame.expected) frame.expected = train_->expected_contrast(frame.row, frame.match);
      expected += *frame.expected / count;
    }
  report.margin = static_cast<uint32_t>(
      std::max<int64_t>(report.margin + evidence_margin(contrast, expected), 0));
  return contrast;
}

FeatureChoice choose_changes(ElementType element,
                             const std::optional<TrainStatistics>& statistics) {
  const auto typical_distance =
      statistics ? std::optional(statistics->typical_distance) : std::nullopt;
  std::vector<std::vector<uint8_t>> chosen;  // only the last one if the distance is known
  double distances = 0;
  return [=, &distance = distance_of(element)](DescriptorRow row) mutable {
    if (!chosen.empty()) {
      const double typical =
          typical_distance.value_or(distances / static_cast<double>(chosen.size()));
      if (distance.pair(row, chosen.back()) < kChange * typical) return false;
      distances += distance.pair(row, chosen[chosen.size() / 2]);
    }
    if (typical_distance) chosen.clear();
    chosen.emplace_back(row.begin(), row.end());
    return true;
  };
}

FeatureChoice tested_frames(const SequenceDatabase& database, const Rule& rule) {
  const auto* filter = std::get_if<Filter>(&rule);
  if (filter == nullptr || filter->witness == Witness::none || !database.features) return {};
  return choose_changes(database.descriptors.shape().element, database.statistics);
}

}  // namespace vpr
