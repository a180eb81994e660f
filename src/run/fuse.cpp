#include "run/fuse.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "fabmap/train.h"

namespace vpr {

namespace {

/// A group of FAB-MAP's database, and its first view.
struct Group {
  const ViewGroup* group = nullptr;
  size_t first_view = 0;
};

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw Error(ErrorKind::data,
              fmt::format("{}: {}; train it with the same sequences as the other database, as in "
                          "vpr-train fabmap --pretrain OTHER --train SEQUENCE",
                          name, why));
}

bool has_frames_of(const Sequence& group, const Sequence& sequence) {
  return group.name == sequence.name && group.frame_names == sequence.frame_names &&
         group.unreadable == sequence.unreadable;
}

// Why no group is of the sequence's frames.
std::string difference(const FabmapDatabase& fabmap, const Sequence& sequence) {
  const auto found =
      std::find_if(fabmap.groups.begin(), fabmap.groups.end(),
                   [&](const ViewGroup& group) { return group.sequence.name == sequence.name; });
  if (found == fabmap.groups.end())
    return fmt::format("has no training sequence {}", sequence.name);
  const Sequence& named = found->sequence;
  if (named.frames != sequence.frames)
    return fmt::format("{} has {}, and {} in the other database", sequence.name,
                       counted(named.frames, "frame"), sequence.frames);
  const auto [own, other] = std::ranges::mismatch(named.frame_names, sequence.frame_names);
  if (own != named.frame_names.end())
    return fmt::format("frame {} of {} is {}, and {} in the other database",
                       own - named.frame_names.begin(), sequence.name, *own, *other);
  return fmt::format("other frames of {} could not be decoded", sequence.name);
}

Group group_of(const FabmapDatabase& fabmap, const Sequence& sequence, const std::string& name) {
  size_t first = 0;
  for (const ViewGroup& group : fabmap.groups) {
    if (has_frames_of(group.sequence, sequence)) return {&group, first};
    first += group.sequence.frames;
  }
  refuse(name, difference(fabmap, sequence));
}

}  // namespace

void fuse_views(SequenceDatabase& database, FabmapDatabase fabmap, const std::string& name) {
  if (database.descriptors.kind->is_imported)
    throw Error(ErrorKind::data,
                fmt::format("{}: can't be fused with a database of imported descriptors, for "
                            "FAB-MAP needs the images of a query",
                            name));
  FusedViews fused;
  for (const auto& [sequence, typical, half_width] : database.sequences) {
    const Group found = group_of(fabmap, sequence, name);
    const size_t first = fused.views.size();
    fused.frames.push_back(sequence.frames);
    for (size_t i = 0; i < sequence.frames; ++i) {
      const size_t view = found.first_view + i;
      const auto words = fabmap.views.view(view);
      fused.views.push_back(static_cast<uint32_t>(view));
      fused.words.emplace_back(words.begin(), words.end());
    }
    for (const size_t frame : sequence.unreadable) fused.views[first + frame] = FusedViews::kNoView;
  }
  fused.fabmap = std::move(fabmap);
  fused.vocabulary = make_vocabulary(fused.fabmap.vocabulary);
  database.statistics.value().fused = std::make_shared<const FusedViews>(std::move(fused));
}

void fuse_views(SequenceDatabase& database, const SequenceQuerySettings& settings,
                const std::string& path) {
  if (!path.empty()) return fuse_views(database, read_fabmap_database(path), path);
  if (settings.fusion_weight)
    throw Error(ErrorKind::usage,
                "fuse_beta is for scores that are fused with FAB-MAP's; give its database of the "
                "same training sequences, too, as in --fuse FABMAP.vprdb");
}

void warn_of_automatic(const SequenceQuerySettings& settings, const Monitor& monitor) {
  if (!settings.fusion_weight || settings.decision != Decision::margin || settings.margin) return;
  warn(monitor,
       "the automatic margin was made for scores that are not fused: with --fuse it accepts more "
       "wrong places where places look alike; set a number, as vpr-tune fastable --fuse finds it "
       "on a sequence with ground truth");
}

const FusedViews* fused_views(const SequenceDatabase& database) {
  return database.statistics ? database.statistics->fused.get() : nullptr;
}

DescriptorSet describe_both(const SequenceSource& sequence, const SequenceDatabase& database,
                            Unreadable unreadable, const Monitor& monitor) {
  const DescriptorKind& kind = *database.descriptors.kind;
  const FusedViews& fused = *fused_views(database);
  const FeatureSettings& features = fused.fabmap.settings.features;
  if (database.descriptor.illumination_invariant) {
    DescriptorSet set = kind.describe(sequence, database.descriptor, unreadable, monitor);
    SequenceSource all = sequence;
    all.argument.warp.clear();  // which describe_frames applies
    set.words = describe_words(all, fused.fabmap, unreadable == Unreadable::skip, monitor).words;
    return set;
  }
  WordCollector words(features, fused.vocabulary);
  DescriptorSet set =
      kind.describe(sequence, database.descriptor, unreadable, monitor, std::ref(words));
  set.words = words.take(set.sequence.frames);
  return set;
}

void WordCollector::operator()(size_t index, const cv::Mat& gray) {
  WordSet words = quantize(vocabulary_, find_features(gray, features_).descriptors);
  const std::lock_guard lock(mutex_);
  if (index >= words_.size()) words_.resize(index + 1);
  words_[index] = std::move(words);
}

std::vector<WordSet> WordCollector::take(size_t frames) {
  words_.resize(frames);
  return std::move(words_);
}

}  // namespace vpr
