#include "descriptors/frame_descriptors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <mutex>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "descriptors/illumination.h"

namespace vpr {
namespace {

DescriptorSet describe_by_ldb(const Sequence& sequence, const DescriptorSettings& settings,
                              Unreadable unreadable, const Monitor& monitor) {
  const PixelFormat format = settings.illumination_invariant ? PixelFormat::bgr : PixelFormat::grey;
  std::mutex mutex;  // a video's length is not known before its end
  std::vector<LdbCode> codes(sequence.files.size());
  FrameList frames = for_each_frame(
      sequence, format, unreadable, monitor, [&](size_t index, const cv::Mat& image) {
        const LdbCode code =
            describe_ldb(settings.illumination_invariant ? illumination_invariant(image) : image);
        const std::lock_guard lock(mutex);
        if (index >= codes.size()) codes.resize(index + 1);
        codes[index] = code;
      });
  return ldb_set(codes, std::move(frames));
}

constexpr std::array<DescriptorKind, 1> kKinds = {{
    {"ldb", "a binary code of the whole frame, of 1386 bits", kLdbShape, describe_by_ldb},
}};

}  // namespace

std::span<const DescriptorKind> descriptor_kinds() { return kKinds; }

const DescriptorKind* find_descriptor_kind(std::string_view name) {
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(),
                                 [&](const DescriptorKind& row) { return row.name == name; });
  return kind == kKinds.end() ? nullptr : &*kind;
}

const DescriptorKind& descriptor_kind(std::string_view name) {
  if (const DescriptorKind* kind = find_descriptor_kind(name)) return *kind;
  std::vector<std::string_view> names;
  for (const DescriptorKind& kind : kKinds) names.push_back(kind.name);
  throw Error(ErrorKind::usage, fmt::format("unknown descriptor \"{}\"; choose one of {}", name,
                                            fmt::join(names, ", ")));
}

DescriptorRows DescriptorStore::rows() const {
  if (!owned.empty() || mapped.shape().empty()) return {kind->shape, owned};
  return {kind->shape, mapped.values<uint8_t>(2)};
}

void DescriptorStore::append(const DescriptorRows& more) {
  assert(mapped.shape().empty() && more.shape == kind->shape);
  owned.insert(owned.end(), more.bytes.begin(), more.bytes.end());
}

DescriptorSet replayed(DescriptorSet set, const std::string& warp, uint64_t seed) {
  if (warp.empty()) return set;
  DescriptorSet result;
  result.descriptors.kind = set.descriptors.kind;
  result.frames = replayed(set.frames, replay(warp, set.frames.count(), seed));
  const DescriptorRows rows = set.rows();
  for (const uint32_t source : result.frames.replay->sources)
    result.descriptors.append(rows.subspan(source, 1));
  return result;
}

DescriptorSet ldb_set(std::span<const LdbCode> codes, FrameList frames) {
  DescriptorSet set;
  set.descriptors.kind = find_descriptor_kind("ldb");
  set.descriptors.append(codes);
  set.frames = std::move(frames);
  return set;
}

std::vector<LdbCode> ldb_codes(const DescriptorSet& set) {
  const DescriptorRows rows = set.rows();
  assert(rows.shape == kLdbShape);
  std::vector<LdbCode> codes(rows.size());
  if (!codes.empty()) std::memcpy(codes.data(), rows.bytes.data(), rows.bytes.size());
  return codes;
}

}  // namespace vpr
