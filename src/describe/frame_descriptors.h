// The table of frame descriptors, and what a sequence or a database holds of them.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "base/npy.h"
#include "describe/descriptor_rows.h"
#include "sequence/frames.h"
#include "sequence/sequence.h"

namespace vpr {

/// Settings of all kinds; each reads its own.
struct DescriptorSettings {
  bool illumination_invariant = false;  ///< decode in colour and remove the light's colour first
  double unit = 0;  ///< of coordinates; no setting of a user: a database's (DescriptorStore)
};

template <class Visitor>
void visit_fields(DescriptorSettings& settings, Visitor&& visit) {
  visit("illumination_invariant", settings.illumination_invariant);
}

struct DescriptorSet;

/// What else looks at a frame once it is decoded; called as for_each_frame calls its body.
using FrameVisitor = std::function<void(size_t index, const cv::Mat& image)>;

/// A row of the table: how frames are described.
struct DescriptorKind {
  std::string_view name;  ///< in flags and manifests
  std::string_view summary;
  DescriptorShape shape;  ///< of length 0 where every set says its own
  DescriptorSet (*describe_with)(const DescriptorKind& kind, const Sequence& sequence,
                                 const DescriptorSettings& settings, Unreadable unreadable,
                                 const FrameVisitor& visit, const Monitor& monitor);
  bool is_imported = false;  ///< its sequences are arrays of descriptors, not frames

  /// Decodes and describes in parallel, no frame kept. Same result for any number of threads; all
  /// zero for an unreadable frame. `visit`, if it is set, gets each readable frame as it was
  /// decoded: grey, or BGR if descriptors are illumination invariant; none of imported descriptors.
  /// Throws what for_each_frame throws, or import_descriptors.
  DescriptorSet describe(const Sequence& sequence, const DescriptorSettings& settings,
                         Unreadable unreadable, const Monitor& monitor,
                         const FrameVisitor& visit = nullptr) const;
};

/// The kinds, LDB first: what a manifest without a name holds.
std::span<const DescriptorKind> descriptor_kinds();

/// The row of that name, or null.
const DescriptorKind* find_descriptor_kind(std::string_view name);

/// The same; for an unknown name throws Error(usage), which lists those that describe frames.
const DescriptorKind& descriptor_kind(std::string_view name);

/// What stands for frames of which only distances are known (match/given_distances.h): their
/// numbers. No database that is stored has it, and no flag names it.
const DescriptorKind& given_kind();

/// Descriptors of one kind: of a fresh description, or the memory-mapped ones of a stored database.
struct DescriptorStore {
  const DescriptorKind* kind = &descriptor_kinds().front();
  std::vector<uint8_t> owned;
  NpyArray mapped;
  size_t length = 0;  ///< of a kind whose sets say it; 0 before the first is appended
  double unit = 0;    ///< of coordinates: what 1 is; 0: no such kind, or not known yet

  DescriptorShape shape() const;
  DescriptorRows rows() const;
  /// Only where nothing is mapped, and of the same shape; to an empty store, of the same kind.
  void append(const DescriptorRows& more);
};

/// The frames of one sequence and their descriptors.
struct DescriptorSet {
  DescriptorStore descriptors;
  FrameList frames;
  const GivenDistances* given = nullptr;  ///< where the distances of these frames are known already
  std::vector<WordSet> words = {};        ///< that each frame shows, where FAB-MAP is asked, too

  DescriptorRows rows() const { return descriptors.rows(); }
  DescriptorSpan span() const { return {rows(), frames.unreadable, given, words}; }
};

/// The set with its frames replayed by `warp` (sequence/selection.h); as it is where that is empty.
/// Rows are repeated or left out, and no frame is described again. Throws as replay does.
DescriptorSet replayed(DescriptorSet set, const std::string& warp, uint64_t seed);

/// LDB codes as a set, and back.
DescriptorSet ldb_set(std::span<const LdbCode> codes, FrameList frames);
/// The codes of a set, which must hold LDB codes.
std::vector<LdbCode> ldb_codes(const DescriptorSet& set);

}  // namespace vpr
