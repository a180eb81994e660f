// The table of frame descriptors, and the descriptors of a sequence or a database.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/npy.h"
#include "database/descriptor_rows.h"
#include "database/keyframe_features.h"
#include "recordings/frames.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// Settings of all descriptors; each one uses its own.
struct DescriptorSettings {
  bool illumination_invariant = false;  ///< decode in color and remove the color of the light first
  double unit = 0;  ///< of coordinates; set by the database (DescriptorStore), not by the user
  double crop = 1;  ///< the middle part of the width and height to describe; set by advice only
};
VPR_FIELDS(DescriptorSettings,
           (illumination_invariant,
            "Convert colors to an illumination-invariant image before description."))

/// The format in which frames are decoded.
PixelFormat pixel_format(const DescriptorSettings& settings);

struct DescriptorSet;

/// An entry of the table: one kind of descriptor.
struct DescriptorKind {
  std::string_view name;  ///< in flags and manifests
  std::string_view summary;
  DescriptorShape shape;  ///< length 0 if each set has its own length
  DescriptorSet (*describe_with)(const DescriptorKind& kind, const SequenceSource& sequence,
                                 const DescriptorSettings& settings, Unreadable unreadable,
                                 const FeatureChoice& choose, const Monitor& monitor);
  bool is_imported = false;  ///< its sequences are arrays of descriptors instead of frames

  /// Decodes and describes frames in parallel without keeping them. The result is the same for any
  /// number of threads; the descriptor of an unreadable frame is all zero. Throws as
  /// for_each_frame or import_descriptors does. `choose`: the frames that get features; null: none.
  DescriptorSet describe(const SequenceSource& sequence, const DescriptorSettings& settings,
                         Unreadable unreadable, const Monitor& monitor,
                         const FeatureChoice& choose = {}) const;
};

/// All kinds, the default first: LDB.
std::span<const DescriptorKind> descriptor_kinds();

/// The kind with this name, or null.
const DescriptorKind* find_descriptor_kind(std::string_view name);

/// The kind with this name. For an unknown name, throws Error(usage), which lists the kinds that
/// describe frames.
const DescriptorKind& descriptor_kind(std::string_view name);

/// Descriptors of one kind: in memory, or memory-mapped from a stored database. Copies share an
/// array.
struct DescriptorStore {
  const DescriptorKind* kind = &descriptor_kinds().front();
  std::vector<uint8_t> owned;
  std::shared_ptr<const NpyArray> array;  ///< of bytes, one row per frame; null: `owned`
  size_t length = 0;  ///< of kinds with a length per set; 0 before the first append
  double unit = 0;    ///< value of a stored coordinate of 1; 0: other kinds, or not known yet

  DescriptorShape shape() const;
  DescriptorRows rows() const;
  /// Requires an empty store of the same kind, or rows of the same shape.
  void append(const DescriptorRows& more);
  /// Moves all rows of another store instead of copying them if this one is empty.
  void append(DescriptorStore&& more);
};

struct DescriptorSet {
  DescriptorStore descriptors;
  Sequence sequence;
  KeyframeFeatures features = {};  ///< of chosen frames; unspecified for frames at a speed
  FeatureLookup features_of = {};  ///< of a query with a witness

  DescriptorRows rows() const { return descriptors.rows(); }
  DescribedFrames span() const { return {rows(), sequence.unreadable}; }
};

/// The set with the selected frames: repeats or omits rows without describing frames again.
DescriptorSet selected(DescriptorSet set, const Selection& selection);

/// The codes of a set, which must hold LDB codes.
std::vector<LdbCode> ldb_codes(const DescriptorSet& set);

}  // namespace vpr
