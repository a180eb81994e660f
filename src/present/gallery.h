// The gallery of a report's page: queries that are worth looking at, with small pictures.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "evaluate/judgment.h"
#include "sequence/selection.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// What a picture pair shows.
enum class GalleryKind { mistake, recognition, weak };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<GalleryKind> = {"mistake",
                                                                            "recognition", "weak"};

/// A query frame beside the training frame that it was taken for.
struct GalleryItem {
  GalleryKind kind = GalleryKind::mistake;
  size_t query = 0;                 ///< index into Outcomes::queries; it has a best match
  std::optional<FrameMatch> truth;  ///< where it should have been, if that is known
};

/// The worst mistakes (the most confident incorrect best matches), the best recognitions and the
/// weakest correct best matches: at most `most` of each, in this order; where the ground truth is
/// not known, the best and the weakest of all best matches. Of queries less than a window (or five
/// frames) apart the first in this order is taken; ties go to the earlier query. A query stands for
/// one kind only.
std::vector<GalleryItem> choose_gallery(const Judgment& judgment, const GroundTruth& truth,
                                        size_t most);

/// At most `most` frames of the window that ends at `anchor`, evenly spaced, the anchor among them.
std::vector<size_t> strip_frames(size_t anchor, size_t window_length, size_t most);

/// A small picture of a frame.
struct Thumbnail {
  std::string name;             ///< the frame's file, or "#12" of a video
  std::vector<std::byte> jpeg;  ///< empty where the frame could not be read
};

/// At most `side` pixels a side, in color. Of a folder or list only the wanted files are read, of
/// a video all frames. Frames that are not there are left out. Throws Error(input) as
/// for_each_frame does for a sequence without any readable frame.
std::map<size_t, Thumbnail> make_thumbnails(const SequenceSource& sequence,
                                            const std::set<size_t>& wanted, int side,
                                            const Monitor& monitor);

/// The same for frames that are selected of the recording.
std::map<size_t, Thumbnail> make_thumbnails(const SequenceSource& recording,
                                            const Selection& selection,
                                            const std::set<size_t>& wanted, int side,
                                            const Monitor& monitor);

/// Where a report's frames can be seen. References are the training sequences in the order of the
/// ground truth's scope; an absent one has no pictures.
struct FrameSources {
  std::optional<SequenceSource> query;
  std::vector<std::optional<SequenceSource>> references;
};

/// The cards of the gallery, with the pictures that they need. What is given must stay alive.
class GalleryCards {
 public:
  GalleryCards(const Judgment& judgment, const GroundTruth& truth, const FrameSources& sources);

  /// Throws as make_thumbnails does.
  void read_frames(const Monitor& monitor);

  std::string html() const;
  std::string note() const;

 private:
  const QueryOutcome& outcome_of(const GalleryItem& item) const;
  std::vector<size_t> frames_at(size_t anchor) const;
  std::string place(const FrameMatch& match) const;
  std::string reference_strip(const std::string& title, const FrameMatch& match) const;
  std::string card(const GalleryItem& item) const;

  const Judgment& judgment_;
  const FrameSources& sources_;
  bool is_judged_;
  std::vector<GalleryItem> items_;
  std::map<size_t, Thumbnail> query_;
  std::vector<std::map<size_t, Thumbnail>> references_;
};

}  // namespace vpr
