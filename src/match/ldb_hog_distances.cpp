// Distances of frames with two descriptors, LDB and HOG.
#include <memory>

#include "match/frame_distances.h"

namespace vpr {
namespace {

// A cosine distance, in units of 2/65535, is divided by 2^kShift and rounded to nearest, ties up.
constexpr uint32_t kShift = 8;

constexpr uint32_t hog_bits(uint32_t cosine) { return (cosine + (1U << kShift >> 1)) >> kShift; }

DescriptorRow ldb_of(DescriptorRow row) { return row.first(kLdbBytes); }
DescriptorRow hog_of(DescriptorRow row) { return row.subspan(kLdbBytes); }

/// One of the descriptors of all frames of a sequence.
struct Part {
  std::vector<uint8_t> bytes;
  DescribedFrames frames;

  Part(const DescribedFrames& sequence, const DescriptorShape& shape,
       DescriptorRow (*of)(DescriptorRow))
      : frames(sequence) {
    for (size_t i = 0; i < sequence.rows.size(); ++i) {
      const DescriptorRow row = of(sequence.rows[i]);
      bytes.insert(bytes.end(), row.begin(), row.end());
    }
    frames.rows = {shape, bytes};
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
};

/// The training frames of one descriptor, prepared by its own distance.
struct PreparedPart {
  const DistanceKind& kind;
  DescriptorShape shape;
  DescriptorRow (*of)(DescriptorRow);
  std::vector<std::unique_ptr<Part>> train;
  PreparedTraining prepared;

  PreparedPart(const DistanceKind& by, const DescriptorShape& part_shape,
               DescriptorRow (*part_of)(DescriptorRow), std::span<const DescribedFrames> sequences)
      : kind(by), shape(part_shape), of(part_of) {
    std::vector<DescribedFrames> parts;
    for (const DescribedFrames& sequence : sequences) {
      train.push_back(std::make_unique<Part>(sequence, shape, of));
      parts.push_back(train.back()->frames);
    }
    prepared = kind.prepare(parts, shape);
  }

  // The tiles of a query.
  auto tile_of(const DescribedFrames& query) const {
    const auto part = std::make_shared<Part>(query, shape, of);
    FrameDistances distances;
    distances.query = part->frames;
    prepared(distances);
    return [part, tile = std::move(distances.tile)](std::span<const uint32_t> queries, size_t first,
                                                    size_t last, uint16_t* out, size_t stride) {
      tile(queries, first, last, out, stride);
    };
  }
};

PreparedTraining prepare(std::span<const DescribedFrames> train, const DescriptorShape&) {
  const auto ldb = std::make_shared<PreparedPart>(kHammingDistance, kLdbShape, ldb_of, train);
  const auto hog = std::make_shared<PreparedPart>(kCosineDistance, kHogShape, hog_of, train);
  return [ldb, hog](FrameDistances& distances) {
    distances.tile = [ldb, hog, ldb_tile = ldb->tile_of(distances.query),
                      hog_tile = hog->tile_of(distances.query)](std::span<const uint32_t> queries,
                                                                size_t first, size_t last,
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
  const DescribedFrames all{to, {}};
  const Part ldb(all, kLdbShape, ldb_of);
  const Part hog(all, kHogShape, hog_of);
  return [by_ldb = kHammingDistance.projector(ldb.frames.rows, weights),
          by_hog = kCosineDistance.projector(hog.frames.rows, weights)](DescriptorRow row) {
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
