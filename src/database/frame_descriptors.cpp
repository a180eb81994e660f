#include "database/frame_descriptors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/named_table.h"
#include "database/imported.h"
#include "database/whole_frame.h"

namespace vpr {
namespace {

// The middle part of an image, of a share of its width and height.
cv::Mat middle_of(const cv::Mat& image, double share) {
  const int width = std::max(1, cvRound(share * image.cols));
  const int height = std::max(1, cvRound(share * image.rows));
  return image({(image.cols - width) / 2, (image.rows - height) / 2, width, height}).clone();
}

/// Finds the features of chosen frames. Frames arrive in any order from several threads; their
/// images are kept until all frames before them have arrived.
class FeatureFinder {
 public:
  explicit FeatureFinder(const FeatureChoice& choose) : choose_(choose) {}

  /// An empty `gray`: an unreadable frame.
  void take(size_t frame, const cv::Mat& gray, DescriptorRow descriptor) {
    if (!choose_) return;
    Arrived arrived{gray.empty() ? gray : working_image(gray), {}};
    arrived.descriptor.assign(descriptor.begin(), descriptor.end());
    std::vector<std::pair<uint32_t, cv::Mat>> chosen;
    {
      const std::lock_guard lock(mutex_);
      waiting_.emplace(frame, std::move(arrived));
      for (; !waiting_.empty() && waiting_.begin()->first == next_; ++next_) {
        const auto& [working, row] = waiting_.begin()->second;
        if (!working.empty() && choose_(row)) chosen.emplace_back(next_, working);
        waiting_.erase(waiting_.begin());
      }
    }
    for (const auto& [index, working] : chosen) {
      std::vector<LocalFeature> features = find_local_features(working);
      const std::lock_guard lock(mutex_);
      found_[index] = std::move(features);
    }
  }

  KeyframeFeatures result() const {
    KeyframeFeatures features;
    for (const auto& [frame, found] : found_) features.append(frame, found);
    return features;
  }

 private:
  struct Arrived {
    cv::Mat working;
    std::vector<uint8_t> descriptor;
  };
  const FeatureChoice& choose_;
  std::mutex mutex_;
  size_t next_ = 0;  ///< the first frame that has not arrived
  std::map<size_t, Arrived> waiting_;
  std::map<uint32_t, std::vector<LocalFeature>> found_;
};

// Writes one descriptor per frame, computed from the gray image, to an array of row_bytes() bytes.
template <auto describe_gray>
DescriptorSet describe_by(const DescriptorKind& kind, const SequenceSource& sequence,
                          const DescriptorSettings& settings, Unreadable unreadable,
                          const FeatureChoice& choose, const Monitor& monitor) {
  const PixelFormat format = pixel_format(settings);
  const size_t row_bytes = kind.shape.row_bytes();
  std::mutex mutex;  // the length of a video is unknown before its end
  DescriptorSet set;
  set.descriptors.kind = &kind;
  std::vector<uint8_t>& rows = set.descriptors.owned;
  rows.resize(sequence.files.size() * row_bytes);
  FeatureFinder features(choose);
  const auto skip = [&](size_t index) { features.take(index, {}, {}); };
  set.sequence = for_each_frame(
      sequence, format, unreadable, monitor,
      [&](size_t index, const cv::Mat& frame) {
        const cv::Mat image = settings.crop < 1 ? middle_of(frame, settings.crop) : frame;
        const auto row =
            describe_gray(settings.illumination_invariant ? illumination_invariant(image) : image);
        assert(row.size() * sizeof(row[0]) == row_bytes);
        const DescriptorRow bytes(reinterpret_cast<const uint8_t*>(row.data()), row_bytes);
        if (choose) features.take(index, in_format(image, PixelFormat::gray), bytes);
        const std::lock_guard lock(mutex);
        if (index >= rows.size() / row_bytes) rows.resize((index + 1) * row_bytes);
        std::memcpy(rows.data() + index * row_bytes, row.data(), row_bytes);
      },
      skip);
  set.features = features.result();
  rows.resize(set.sequence.frames * row_bytes);  // the last frame of a video may have no image
  return set;
}

DescriptorSet import_kind(const DescriptorKind& kind, const SequenceSource& sequence,
                          const DescriptorSettings& settings, Unreadable unreadable,
                          const FeatureChoice&, const Monitor& monitor) {
  return import_descriptors(sequence, kind.name, unreadable, monitor, settings.unit);
}

constexpr DescriptorKind imported(std::string_view name, std::string_view summary,
                                  ElementType element) {
  return {name, summary, {element, 0}, import_kind, true};
}

constexpr std::array<DescriptorKind, 9> kKinds = {{
    {"ldb", "a binary code of the whole frame, of 1386 bits", kLdbShape, describe_by<describe_ldb>},
    {"thumbnail",
     "the frame in 64x32 gray levels, normalized in squares, as in SeqSLAM",
     {ElementType::gray_levels, std::tuple_size_v<Thumbnail64>},
     describe_by<describe_thumbnail>},
    {"hog", "histograms of oriented gradients of the whole frame, 288 values", kHogShape,
     describe_by<describe_hog>},
    {"ldb+hog", "both, for z-scores and the filter; other methods use ldb", kLdbHogShape,
     describe_by<describe_ldb_hog>},
    imported(kVectorKind, "vectors from files, as 16-bit integers", ElementType::int16),
    imported(kNarrowVectorKind, "vectors from files, as 8-bit integers", ElementType::int8),
    imported(kPointKind, "vectors from files with their lengths, as 16-bit integers",
             ElementType::points16),
    imported(kDirectionKind, "vectors from files scaled to length 1, as 16-bit integers",
             ElementType::points16),
    imported(kBitKind, "bits from files", ElementType::bits),
}};

}  // namespace

PixelFormat pixel_format(const DescriptorSettings& settings) {
  return settings.illumination_invariant ? PixelFormat::bgr : PixelFormat::gray;
}

DescriptorSet DescriptorKind::describe(const SequenceSource& sequence,
                                       const DescriptorSettings& settings, Unreadable unreadable,
                                       const Monitor& monitor, const FeatureChoice& choose) const {
  return describe_with(*this, sequence, settings, unreadable, choose, monitor);
}

std::span<const DescriptorKind> descriptor_kinds() { return kKinds; }

const DescriptorKind* find_descriptor_kind(std::string_view name) { return find_in(kKinds, name); }

const DescriptorKind& descriptor_kind(std::string_view name) {
  if (const DescriptorKind* kind = find_descriptor_kind(name)) return *kind;
  std::vector<std::string_view> names;
  for (const DescriptorKind& kind : kKinds)
    if (!kind.is_imported) names.push_back(kind.name);
  throw Error(ErrorKind::usage, "unknown descriptor \"{}\"; choose one of {}", name,
              fmt::join(names, ", "));
}

DescriptorShape DescriptorStore::shape() const {
  return {kind->shape.element, kind->shape.length == 0 ? length : kind->shape.length};
}

DescriptorRows DescriptorStore::rows() const {
  if (!array) return {shape(), owned};
  return {shape(), array->values<uint8_t>(2)};
}

void DescriptorStore::append(const DescriptorRows& more) {
  if (rows().empty() && kind->shape.length == 0) length = more.shape.length;
  assert(more.shape == shape());
  if (array) {
    const std::span<const uint8_t> bytes = rows().bytes;
    owned.assign(bytes.begin(), bytes.end());
    array = nullptr;
  }
  owned.insert(owned.end(), more.bytes.begin(), more.bytes.end());
}

void DescriptorStore::append(DescriptorStore&& more) {
  if (!rows().empty()) return append(more.rows());
  assert(more.kind == kind);
  owned = std::move(more.owned);
  array = std::move(more.array);
  length = more.length;
}

DescriptorSet selected(DescriptorSet set, const Selection& selection) {
  if (selection.is_all()) return set;
  DescriptorSet result;
  result.descriptors.kind = set.descriptors.kind;
  result.descriptors.unit = set.descriptors.unit;
  const DescriptorRows rows = set.rows();
  for (const uint32_t source : selection.sources)
    result.descriptors.append(rows.subspan(source, 1));
  result.sequence = selected(set.sequence, selection);
  if (set.features_of)
    result.features_of = [of = set.features_of, sources = selection.sources](size_t frame) {
      return of(sources[frame]);
    };
  return result;
}

std::vector<LdbCode> ldb_codes(const DescriptorSet& set) {
  const DescriptorRows rows = set.rows();
  assert(rows.shape == kLdbShape);
  std::vector<LdbCode> codes(rows.size());
  if (!codes.empty()) std::memcpy(codes.data(), rows.bytes.data(), rows.bytes.size());
  return codes;
}

}  // namespace vpr
