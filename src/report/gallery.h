// Which queries are worth looking at.
#pragma once

#include <optional>
#include <vector>

#include "evaluation/judgement.h"

namespace vpr {

/// What a picture pair shows.
enum class GalleryKind { mistake, hit, weak };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<GalleryKind> = {"mistake", "hit",
                                                                            "weak"};

/// A query frame beside the training frame that it was taken for.
struct GalleryItem {
  GalleryKind kind = GalleryKind::mistake;
  size_t query = 0;                 ///< index into Outcomes::queries; it has a best match
  std::optional<FrameMatch> truth;  ///< where it should have been, if that is known
};

/// The worst mistakes (the most confident incorrect best matches), the best hits and the weakest
/// correct best matches: at most `most` of each, in this order; where the ground truth is not
/// known, the best and the weakest of all best matches. Of queries less than a window (or
/// five frames) apart the first in this order is taken; ties go to the earlier query. A query
/// stands for one kind only.
std::vector<GalleryItem> choose_gallery(const Judgement& judgement, const GroundTruth& truth,
                                        size_t most);

/// At most `most` frames of the window that ends at `anchor`, evenly spaced, the anchor among them.
std::vector<size_t> strip_frames(size_t anchor, size_t window_length, size_t most);

}  // namespace vpr
