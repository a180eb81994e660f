// The second witness: local features of keyframes add evidence to the margins of the filter's paths
// (docs/reference/methods.md).
#pragma once

#include <complex>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "database/keyframe_features.h"
#include "match/match.h"
#include "query/prepare.h"

namespace vpr {

/// Chooses frames that differ from the last chosen one by 0.4 typical distances. Without
/// statistics, the typical distance is estimated from the chosen frames: the mean distance of each
/// to the one of half its number.
FeatureChoice choose_changes(ElementType element,
                             const std::optional<TrainStatistics>& statistics = {});

/// Chooses the tested frames of a query. Null for a rule without a witness, or a database without
/// features.
FeatureChoice tested_frames(const SequenceDatabase& database, const Rule& rule);

/// The positions of a feature of two images, in pixels of their working images.
struct PointPair {
  std::complex<double> query;
  std::complex<double> train;
};

/// The most pairs of features for which one similarity transform maps `query` to `train` within 8
/// pixels, with a scale of 1/2 to 2 and a rotation of at most 20 degrees. A pair of features is
/// considered if its distance is below 0.8 of the distance to the second best feature of `train`;
/// each feature of `train` occurs once.
std::vector<PointPair> inliers(std::span<const LocalFeature> query,
                               std::span<const LocalFeature> train);

/// Finds the features of one frame.
using FeaturesOfFrame = std::function<std::vector<LocalFeature>()>;

/// The training keyframes of a prepared database with features and statistics. Points into it.
class TrainWitness {
 public:
  explicit TrainWitness(const PreparedDatabase& prepared);

  /// The contrast of a query frame: log((a + 4) / (b + 4)), where a and b are the most inliers of
  /// its match and the two keyframes next to it, and of other places chosen by its number. Nullopt
  /// if there is nothing to compare: few features, no keyframe with features in the sequence, or no
  /// other places.
  std::optional<double> contrast(std::span<const LocalFeature> features, const Cell& match) const;

  /// The contrast of the keyframe of a match to the nearest later one, or else earlier one, that
  /// differs from it at least as the query frame from its match; 0 if none of the ten next ones
  /// does.
  double expected_contrast(DescriptorRow query, const Cell& match) const;

 private:
  size_t keyframe_of(const Cell& match) const;
  DescriptorRow row(size_t keyframe) const;
  std::vector<size_t> other_places(size_t keyframe, size_t number) const;
  std::optional<double> contrast_to(std::span<const LocalFeature> query, size_t first, size_t last,
                                    size_t keyframe, size_t number) const;

  const KeyframeFeatures* features_;
  std::vector<DescribedFrames> train_;
  std::vector<size_t> sequence_starts_;            ///< frames
  std::vector<size_t> sequences_;                  ///< by keyframe
  std::vector<size_t> first_passes_;               ///< by keyframe: keyframe of its first pass
  std::vector<std::vector<uint8_t>> overlapping_;  ///< sequences, [a][b]
};

/// The evidence of this mean contrast, to add to a margin in units of reports. `expected`: of
/// training keyframes as different as the tested frames and their matches.
int64_t evidence_margin(double contrast, double expected);

/// Adds the evidence of the last tested frames of a path to its reports, which arrive in order.
class WitnessStage {
 public:
  /// `choose`: tested_frames of the database.
  WitnessStage(std::shared_ptr<const TrainWitness> train, FeatureChoice choose,
               uint32_t least_margin)
      : train_(std::move(train)), choose_(std::move(choose)), least_margin_(least_margin) {}

  /// Returns the mean contrast of the frames; nullopt if there are too few, or if no evidence can
  /// change on which side of the least margin this one is. `features`: finds those of the frame
  /// when they are needed. A margin of 0 has too few keyframes, or none that is near enough, and
  /// remains 0.
  std::optional<double> add_evidence(PathReport& report, DescriptorRow query,
                                     const FeaturesOfFrame& features);

 private:
  struct Frame {
    Cell match;
    std::vector<uint8_t> row;
    FeaturesOfFrame features;        ///< until it is tested
    std::optional<double> contrast;  ///< set when it is needed first, as `expected`
    std::optional<double> expected;
  };
  void run_tests();

  std::shared_ptr<const TrainWitness> train_;
  FeatureChoice choose_;
  uint32_t least_margin_;
  uint32_t path_ = 0;
  size_t tests_ = 0;          ///< of the path
  size_t omitted_ = 0;        ///< chosen frames since the last one in `frames_`
  std::deque<Frame> frames_;  ///< of the path
};

}  // namespace vpr
