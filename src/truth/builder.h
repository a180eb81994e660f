// Common parts of readers and writers of ground truth: checked pairs, size limits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/monitor.h"
#include "truth/ground_truth.h"
#include "truth/text_file.h"

namespace vpr {

/// The maximum number of examples per kind of problem.
inline constexpr size_t kMaxExamples = 5;

/// The treatment of pairs that are out of range or contradict each other.
enum class InconsistentPairs { refuse, count };

/// The number of frames of one side. If it grows, the largest index in the file determines it.
struct FrameCount {
  size_t frames = 0;
  bool grows = false;

  std::optional<size_t> known() const { return grows ? std::nullopt : std::optional(frames); }
};

/// The index of the only searched sequence. Throws Error(usage) if there are several or none:
/// `what` needs exactly one.
size_t only_searched_sequence(const GroundTruthScope& scope, std::string_view what);

/// Collects the pairs of a reader: checks indices and labels, and counts inconsistencies.
class GroundTruthBuilder {
 public:
  /// `format`: the name of the file's format.
  GroundTruthBuilder(const GroundTruthArgument& argument, std::string_view format,
                     const GroundTruthScope& scope, InconsistentPairs inconsistent,
                     const Monitor& monitor);

  const GroundTruthArgument& argument() const { return argument_; }
  std::string_view format() const { return format_; }
  const GroundTruthScope& scope() const { return scope_; }
  const FrameCount& query() const { return query_; }
  const FrameCount& train(size_t sequence) const { return train_[sequence]; }

  /// As only_searched_sequence.
  size_t only_searched(std::string_view what) const { return only_searched_sequence(scope_, what); }
  /// Throws Error(data) if no sequence has this name.
  size_t find_sequence(const std::string& name);
  /// Checks the number of frames that the file states. Throws Error(data) if it differs.
  void require_query_frames(size_t frames);
  void require_train_frames(size_t sequence, size_t frames) {
    require_frames(train_[sequence], "training", frames);
  }

  /// Sets the current position of the reader for errors; initially the whole file. Throws
  /// Error(interrupted) on a stop, because it is called often.
  void at(std::string_view unit, size_t number) {
    check_stop();
    location_.at(unit, number);
  }
  void check_stop() const { vpr::check_stop(monitor_); }
  void at_file(const std::filesystem::path& path) { location_ = {path.string()}; }
  [[noreturn]] void fail(std::string_view what) const { location_.fail(what); }
  const Monitor& monitor() const { return monitor_; }
  /// Reports a warning, one sentence.
  void warn_user(const std::string& sentence) const { warn(monitor_, sentence); }
  /// Additional text for errors about query frames out of range.
  void set_query_hint(std::string hint) { query_hint_ = std::move(hint); }

  /// Labels references first .. last of `sequence`. Accepts any indices; those out of range are
  /// refused or counted.
  void add(size_t query, size_t sequence, size_t first, size_t last, PlaceLabel label);
  /// A `same` pair whose reference may be after the last frame: frames within the tolerance of it
  /// are labeled.
  void add_beyond_end(size_t query, size_t sequence, size_t reference);
  /// Reports an index `text` that is out of range and cannot become a pair.
  void report_out_of_range(std::string_view what, std::string_view text, const FrameCount& side);

  /// GroundTruth::asked: one entry per query frame.
  void set_asked(std::vector<std::vector<GroundTruth::Pair>> asked) { asked_ = std::move(asked); }

  /// Sorts the pairs, joins them to runs and checks them. `protocol`: a description for reports.
  InspectedGroundTruth finish(std::string protocol);

 private:
  void require_frames(FrameCount& side, std::string_view name, size_t frames);
  void note(FindingKind kind, uint64_t count, const std::string& what);
  bool accept(size_t index, FrameCount& side, std::string_view what);
  void append(size_t query, const GroundTruth::Pair& pair);
  void report_overlaps(size_t query, std::span<const GroundTruth::Pair> kept,
                       const GroundTruth::Pair& pair);
  void join(size_t query);

  const GroundTruthArgument& argument_;
  std::string_view format_;
  GroundTruthScope scope_;
  InconsistentPairs inconsistent_;
  Monitor monitor_;
  std::string query_hint_;
  FrameCount query_;
  std::vector<FrameCount> train_;
  std::vector<std::vector<GroundTruth::Pair>> pairs_;
  std::vector<std::vector<GroundTruth::Pair>> asked_;
  size_t runs_ = 0;
  FileLocation location_;
  std::array<GroundTruthFinding, 3> findings_;
};

/// Checks a size before writing. Throws Error(data) if there are more than `most` of `what`, such
/// as "pairs".
void require_writable(uint64_t count, uint64_t most, std::string_view what);

}  // namespace vpr
