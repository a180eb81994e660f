// Distances of frames with two descriptors, LDB and HOG.
#include "match/frame_distances.h"

namespace vpr {
namespace {

// A cosine distance, in units of 2/65535, is divided by 2^kShift and rounded to nearest, ties up.
constexpr uint32_t kShift = 8;

constexpr uint32_t hog_bits(uint32_t cosine) { return (cosine + (1U << kShift >> 1)) >> kShift; }

DescriptorRow ldb_of(DescriptorRow row) { return row.first(kLdbBytes); }
DescriptorRow hog_of(DescriptorRow row) { return row.subspan(kLdbBytes); }

DescriptorRows hogs_of(const DescriptorRows& rows) {
  if (rows.empty()) return {kHogShape, {}};
  return {kHogShape, rows.bytes.subspan(kLdbBytes), rows.stride};
}

using PartOf = DescriptorRows (*)(const DescriptorRows& rows);

DescribedFrames part_of(DescribedFrames frames, PartOf rows_of) {
  frames.rows = rows_of(frames.rows);
  return frames;
}

PreparedTraining prepare_part(std::span<const DescribedFrames> train, const DistanceKind& kind,
                              const DescriptorShape& shape, PartOf rows_of) {
  std::vector<DescribedFrames> parts;
  for (const DescribedFrames& sequence : train) parts.push_back(part_of(sequence, rows_of));
  return kind.prepare(parts, shape);
}

auto tile_of(const PreparedTraining& prepared, const DescribedFrames& query) {
  FrameDistances distances;
  distances.query = query;
  prepared(distances);
  return distances.tile;
}

PreparedTraining prepare(std::span<const DescribedFrames> train, const DescriptorShape&) {
  return
      [ldb = prepare_part(train, kHammingDistance, kLdbShape, codes_of),
       hog = prepare_part(train, kCosineDistance, kHogShape, hogs_of)](FrameDistances& distances) {
        distances.tile = [ldb_tile = tile_of(ldb, part_of(distances.query, codes_of)),
                          hog_tile = tile_of(hog, part_of(distances.query, hogs_of))](
                             std::span<const uint32_t> queries, size_t first, size_t last,
                             uint16_t* out, size_t stride) {
          const size_t count = round_up(last - first, kBlockFrames);
          std::vector<uint16_t> cosines(queries.size() * count);
          ldb_tile(queries, first, last, out, stride);
          hog_tile(queries, first, last, cosines.data(), count);
          for (size_t t = 0; t < queries.size(); ++t)
            for (size_t i = 0; i < last - first; ++i)
              out[t * stride + i] =
                  static_cast<uint16_t>(out[t * stride + i] + hog_bits(cosines[t * count + i]));
        };
      };
}

Projector make_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  return [by_ldb = kHammingDistance.projector(codes_of(to), weights),
          by_hog = kCosineDistance.projector(hogs_of(to), weights)](DescriptorRow row) {
    ComponentValues values = by_ldb(ldb_of(row));
    const ComponentValues cosines = by_hog(hog_of(row));
    for (size_t k = 0; k < values.size(); ++k) values[k] += cosines[k] / (1U << kShift);
    return values;
  };
}

}  // namespace

const DistanceKind kLdbHogDistance = {
    ElementType::ldb_hog,
    {"bits", 1},
    [](const DescriptorShape&) {
      return static_cast<uint16_t>(kLdbBits + hog_bits(kCosineDistance.largest(kHogShape)));
    },
    [](DescriptorRow a, DescriptorRow b) {
      return kHammingDistance.pair(ldb_of(a), ldb_of(b)) +
             hog_bits(kCosineDistance.pair(hog_of(a), hog_of(b)));
    },
    make_projector,
    prepare};

}  // namespace vpr
