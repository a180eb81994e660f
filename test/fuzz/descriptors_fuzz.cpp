// Any bytes as descriptors of every kind, and their distances to themselves.
#include "database/frame_descriptors.h"
#include "database/imported.h"
#include "fuzz.h"
#include "match/frame_distances.h"

void vpr::fuzz::run(std::string_view input) {
  const std::filesystem::path path = memory_file(input);
  const SequenceSource sequence{{path, {}}, SequenceKind::descriptors, {path}};
  for (const std::string_view kind :
       {kBitKind, kNarrowVectorKind, kVectorKind, kPointKind, kDirectionKind}) {
    DescriptorSet set;
    const bool has_unit = descriptor_kind(kind).shape.element == ElementType::points16;
    if (refuses([&] {
          const double unit = has_unit ? coordinate_unit(kind, {&sequence, 1}, {}) : 0;
          set = import_descriptors(sequence, kind, Unreadable::skip, {}, unit);
        }))
      continue;
    const DescribedFrames span = set.span();
    const FrameDistances distances = frame_distances({&span, 1}, span);
    std::vector<uint16_t> row(set.sequence.frames + kBlockFrames);
    const uint32_t query = 0;
    distances.tile({&query, 1}, 0, set.sequence.frames, row.data(), 0);
    for (size_t i = 0; i < set.sequence.frames; ++i) require(row[i] <= distances.largest);
  }
}
