// FAB-MAP's database: vocabulary, Chow-Liu tree and the words of every view.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "base/output.h"
#include "database/sequence_database.h"
#include "fabmap/chow_liu.h"
#include "fabmap/local_features.h"
#include "fabmap/vocabulary.h"
#include "query/run_info.h"
#include "recordings/sequence.h"

namespace vpr {

/// The algorithm that clusters descriptors into words.
enum class Clustering { kmeans, radius };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Clustering> = {"kmeans", "radius"};

/// Settings of training a vocabulary and a Chow-Liu tree on pretraining frames.
struct FabmapTrainSettings {
  FeatureSettings features;
  Clustering clustering = Clustering::kmeans;
  uint64_t words = 1000;
  uint64_t iterations = 20;
  double radius = 0.4;
  bool skip_unreadable = false;
};

template <class Visitor>
void visit_fields(FabmapTrainSettings& settings, Visitor&& visit) {
  visit_fields(settings.features, visit);
  visit("clustering", settings.clustering, "How words were found.");
  visit("words", settings.words, "Words of the vocabulary.");
  visit("iterations", settings.iterations, "Largest number of k-means steps.");
  visit("radius", settings.radius,
        "Descriptors farther than this from all words become words (radius).");
  visit("skip_unreadable", settings.skip_unreadable);
}

/// Frames that were trained together: each one its own place, or all of them views of one place.
struct ViewGroup {
  Sequence sequence;  ///< its unreadable frames never match
  bool is_place = false;
};

/// The content of a database folder: all training data of FAB-MAP.
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

  /// Views of frames that could not be decoded, increasing.
  std::vector<size_t> unreadable_views() const;
  /// The index of the place of each view: place groups with the same name share one place.
  std::vector<uint32_t> places() const;
  /// Names by place index: the name of the group, or "group#frame".
  std::vector<std::string> place_names() const;
};

/// A database of either family.
using AnyDatabase = std::variant<SequenceDatabase, FabmapDatabase>;

/// Throws as database_family and the readers of both families do.
AnyDatabase read_database(const std::filesystem::path& path);
/// Byte-identical for equal content. The caller commits.
void write_database(const std::filesystem::path& path, const AnyDatabase& database,
                    Outputs& outputs);

/// The names of the groups.
std::vector<std::string> names_of(const FabmapDatabase& database);

/// For each group, the number of frames that were decoded but show no word.
std::vector<size_t> featureless_frames(const FabmapDatabase& database);

/// Appends a group and the words of its frames. Invalidates the index.
void add_group(FabmapDatabase& database, const ViewGroup& group, std::span<const WordSet> frames);

/// Rebuilds the index of all views.
void index_views(FabmapDatabase& database);

/// Verifies every file. Throws Error(input) if a file is missing; Error(data) if it is damaged or
/// belongs to another method or version.
FabmapDatabase read_fabmap_database(const std::filesystem::path& path);

/// The fingerprint that the database has once it is stored.
std::string database_fingerprint(const FabmapDatabase& database);

/// The report of vpr-train info (vpr.database-info/3).
Json database_json(const FabmapDatabase& database, const RunInfo& run);
Json fabmap_manifest_schema();
Json fabmap_info_schema();

/// A table of groups.
std::string database_text(const FabmapDatabase& database, const std::string& name);

}  // namespace vpr
