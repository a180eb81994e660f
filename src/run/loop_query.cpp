#include "run/loop_query.h"

#include <cmath>

#include "describe/imported.h"
#include "run/train.h"
#include "truth/times.h"

namespace vpr {

DescriptorSet describe_walk(const SequenceSource& walk, const SequenceQuerySettings& settings,
                            const Monitor& monitor) {
  const std::string usual(walk.kind == SequenceKind::descriptors ? kVectorKind : "ldb");
  const std::string& name = settings.descriptor.empty() ? usual : settings.descriptor;
  SequenceDatabase described;
  described.descriptors.kind = &descriptor_kind(name);
  if (described.descriptors.kind->shape.element == ElementType::points16)
    described.descriptors.unit = coordinate_unit(name, {&walk, 1}, monitor);
  return describe_frames(walk, described, settings.skip_unreadable, monitor);
}

SequenceDatabase own_walk(const DescriptorSet& query, const std::string& name) {
  SequenceDatabase walk;
  walk.descriptors.kind = query.descriptors.kind;
  walk.descriptors.unit = query.descriptors.unit;
  walk.descriptors.append(query.rows());
  walk.sequences.push_back({query.sequence});
  walk.sequences.back().sequence.name = name;
  walk.shared_places.emplace();
  return walk;
}

LoopGap loop_gap_of(const SequenceQuerySettings& settings) {
  if (settings.loop_gap != 0) return {{}, settings.loop_gap};
  return {std::llround(settings.loop_gap_s * double{kSecond}), 0};
}

}  // namespace vpr
