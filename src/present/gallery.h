// The images of an evaluation, and selected queries with thumbnails, as HTML.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "database/keyframe_features.h"
#include "evaluate/judgment.h"
#include "present/matrix_chart.h"
#include "query/result_file.h"
#include "recordings/sequence_source.h"

namespace vpr {

enum class GalleryKind { mistake, recognition, weak };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<GalleryKind> = {"mistake",
                                                                            "recognition", "weak"};

struct GalleryItem {
  GalleryKind kind = GalleryKind::mistake;
  size_t query = 0;                 ///< index into Outcomes::queries; it has a best match
  std::optional<FrameMatch> truth;  ///< a correct match by the ground truth, if it has one
};

/// Selects the most confident incorrect best matches, then the most and the least confident correct
/// ones, at most `most` of each kind; without ground truth, the most and the least confident of all
/// best matches. For each kind, the path has `most` stretches of equal length; each shows one query
/// before any shows another. Queries of one kind, except mistakes, are at least a window and five
/// frames apart; the earlier in this order stays, and on ties the earlier query. A query has one
/// kind only.
std::vector<GalleryItem> choose_gallery(const Judgment& judgment, const GroundTruth& truth,
                                        size_t most);

/// At most `most` evenly spaced frames of the window that ends at `anchor`, including the anchor.
std::vector<size_t> strip_frames(size_t anchor, size_t window_length, size_t most);

struct Thumbnail {
  std::string name;             ///< file name, or "#12" for frame 12 of a video
  std::vector<std::byte> jpeg;  ///< empty if the frame is unreadable
  std::vector<LocalFeature> features = {};
  double working_side = 0;  ///< longer side of the working image, which has the features
};

struct ThumbnailSettings {
  int side = 160;             ///< of the longer side, in pixels
  bool has_features = false;  ///< finds local features, as the second witness does
};

/// Color images for the `wanted` frames of a selection; frames that do not exist have none. Reads
/// only these files of a folder or list, but all frames of a video. Throws as for_each_frame does.
std::map<size_t, Thumbnail> make_thumbnails(const SequenceSource& recording,
                                            const Selection& selection,
                                            const std::set<size_t>& wanted,
                                            const ThumbnailSettings& settings,
                                            const Monitor& monitor);

/// The images of an evaluation. References are the training sequences of the ground truth's scope,
/// in its order. A missing sequence has no thumbnails.
struct FrameSources {
  std::optional<SequenceSource> query;
  std::vector<std::optional<SequenceSource>> references;
};

/// Thumbnails by frame: of the query, and of each reference.
struct FrameImages {
  std::map<size_t, Thumbnail> query;
  std::vector<std::map<size_t, Thumbnail>> references;
};

/// The frames of an evaluation that are shown.
struct ShownFrames {
  std::set<size_t> query;
  std::vector<std::set<size_t>> references;  ///< by sequence of the scope
};

/// Missing sequences have no images. Throws as make_thumbnails does.
FrameImages read_images(const ShownFrames& frames, const GroundTruthScope& scope,
                        const FrameSources& sources, const ThumbnailSettings& settings,
                        const Monitor& monitor);

/// The sequences of a result, as far as their frames are still the same; none if it is null, and no
/// training sequences of FAB-MAP, whose references are places.
FrameSources recorded_frames(const GroundTruthScope& scope, const StoredResult* stored);

/// By "query 12" and "0 7" (index of the sequence): a data URL, empty for an unreadable frame, and
/// the name.
Json images_json(const FrameImages& images);

struct Gallery {
  std::string kinds;     ///< HTML elements to select cards
  std::string note;      ///< a plain sentence
  std::string cards;     ///< HTML elements
  FrameImages pictured;  ///< of evenly spaced queries and their best matches
};

/// The number of cards and images of a gallery.
struct GallerySize {
  size_t cards_of_a_kind = 9;
  size_t cards = std::numeric_limits<size_t>::max();
  size_t strip_frames = 5;     ///< images per match
  bool has_true_place = true;  ///< also shows a correct match of a mistake
  size_t pictured = 0;         ///< most queries in Gallery::pictured
  bool has_features = false;   ///< of the images in Gallery::pictured
};

/// `unit`: of the scores. Throws as make_thumbnails does.
Gallery make_gallery(const Judgment& judgment, const GroundTruth& truth, const ScoreUnit& unit,
                     const FrameSources& sources, const Monitor& monitor,
                     const GallerySize& size = {});

}  // namespace vpr
