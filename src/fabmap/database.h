// The database of FAB-MAP: vocabulary, Chow-Liu tree, and the words of every view; and the one that
// scores of sequences are fused with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "base/output.h"
#include "fabmap/chow_liu.h"
#include "fabmap/local_features.h"
#include "fabmap/vocabulary.h"
#include "fabmap/word_index.h"

namespace vpr {

/// How descriptors become words.
enum class Clustering { kmeans, radius };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Clustering> = {"kmeans", "radius"};

/// How a vocabulary and a Chow-Liu tree are learned from pretraining frames.
struct FabmapTrainSettings {
  FeatureSettings features;
  Clustering clustering = Clustering::kmeans;
  uint64_t words = 1000;     ///< wanted of k-means; in a database: that there are
  uint64_t iterations = 20;  ///< Lloyd steps at most
  double radius = 0.4;       ///< of radius clustering: who is farther from all centres becomes one
  bool skip_unreadable = false;
};

template <class Visitor>
void visit_fields(FabmapTrainSettings& settings, Visitor&& visit) {
  visit_fields(settings.features, visit);
  visit("clustering", settings.clustering);
  visit("words", settings.words);
  visit("iterations", settings.iterations);
  visit("radius", settings.radius);
  visit("skip_unreadable", settings.skip_unreadable);
}

/// Frames that were trained together: each a place of its own, or all views of one place.
struct ViewGroup {
  std::string name;
  bool is_place = false;
  std::vector<std::string> frame_names;
  std::vector<size_t> unreadable = {};  ///< frames that could not be decoded: they never match
};

/// Where a view comes from.
struct ViewOrigin {
  size_t group = 0;
  size_t frame = 0;  ///< within the group
};

/// All that FAB-MAP needs of training: the content of its database folder.
struct FabmapDatabase {
  FabmapTrainSettings settings;
  uint64_t seed = 1;
  cv::Mat vocabulary;  ///< words x dims, CV_32F or CV_8U
  ChowLiuTree tree;
  ViewWords pretrain;
  ViewWords views;  ///< of all groups, one after the other
  WordIndex index;  ///< of the views
  std::vector<ViewGroup> groups;
  std::string fingerprint;  ///< of a stored database

  /// `view` is below views.views().
  ViewOrigin origin(size_t view) const;
  /// Views of frames that could not be decoded, rising.
  std::vector<size_t> unreadable_views() const;
  /// Per view, the index of its place: groups of the same name that are places share one.
  std::vector<uint32_t> places() const;
  /// Names by place index: the group's, or "group#frame".
  std::vector<std::string> place_names() const;
};

/// How many frames of each group show no word, though they could be decoded.
std::vector<size_t> featureless_frames(const FabmapDatabase& database);

/// Appends a group and the words of its frames. The index is out of date then.
void add_group(FabmapDatabase& database, const ViewGroup& group, std::span<const WordSet> frames);

/// Makes the index of all views anew.
void index_views(FabmapDatabase& database);

/// Every file is verified. Throws Error(input) if it is missing,
/// Error(data) if it is damaged, of another method or of another version.
FabmapDatabase read_fabmap_database(const std::filesystem::path& path);

/// Byte-identical for the same content. The caller commits.
void write_fabmap_database(const std::filesystem::path& path, const FabmapDatabase& database,
                           Outputs& outputs);

/// What FAB-MAP knows of the training frames of a database of sequences: its database of the same
/// frames, each of which is one of its views.
struct FusedViews {
  /// Of a frame that could not be decoded.
  static constexpr uint32_t kNoView = std::numeric_limits<uint32_t>::max();

  FabmapDatabase fabmap;
  Vocabulary vocabulary;        ///< of it, for frames to be described by
  std::vector<size_t> frames;   ///< of each training sequence
  std::vector<uint32_t> views;  ///< by training frame, sequence after sequence
  std::vector<WordSet> words;   ///< that the same frames show
};

}  // namespace vpr
