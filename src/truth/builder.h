// What readers and writers of ground truth formats share: checked pairs, size limits, output
// pieces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/monitor.h"
#include "truth/ground_truth.h"
#include "truth/text_file.h"

namespace vpr {

class Output;

/// What to do about pairs that are out of range or contradict each other.
enum class InconsistentPairs { refuse, count };

/// How many frames one side has; one that grows has as many as its largest index needs.
struct FrameCount {
  size_t frames = 0;
  bool grows = false;
};

/// What readers of formats fill: it checks indices and labels, and counts what is odd.
class GroundTruthBuilder {
 public:
  GroundTruthBuilder(const GroundTruthArgument& argument, const GroundTruthScope& scope,
                     InconsistentPairs inconsistent, const Monitor& monitor);

  const GroundTruthArgument& argument() const { return argument_; }
  const GroundTruthScope& scope() const { return scope_; }
  const FrameCount& query() const { return query_; }
  const FrameCount& train(size_t sequence) const { return train_[sequence]; }

  /// The one sequence that was searched. Throws Error(usage), naming `what` needs it.
  size_t only_searched(std::string_view what) const;
  /// Throws Error(data) if there is none of this name.
  size_t find_sequence(const std::string& name);
  /// The file states how many frames there are: no more and no fewer. Throws Error(data).
  void require_query_frames(size_t frames);
  void require_train_frames(size_t sequence, size_t frames);

  /// Where the reader is, for errors; at first the argument's path as a whole.
  /// Throws Error(interrupted) on a stop: a file has many places.
  void at(std::string_view unit, size_t number) {
    check_stop();
    location_.at(unit, number);
  }
  void check_stop() const { vpr::check_stop(monitor_); }
  void at_file(const std::filesystem::path& path) { location_ = {path.string()}; }
  [[noreturn]] void fail(std::string_view what) const { location_.fail(what); }
  const Monitor& monitor() const { return monitor_; }
  /// One sentence for the user about something that is odd but no error.
  void warn_user(const std::string& sentence) const { warn(monitor_, sentence); }
  /// What an error says more of query frames that are out of range.
  void set_query_hint(std::string hint) { query_hint_ = std::move(hint); }

  /// References first .. last of `sequence` are labelled. Any indices may be given; those that are
  /// out of range are refused or counted.
  void add(size_t query, size_t sequence, size_t first, size_t last, PlaceLabel label);
  /// A `same` pair whose reference may lie behind the last frame, which only the tolerance reaches.
  void add_beyond_end(size_t query, size_t sequence, size_t reference);
  /// An index `text` that is out of range before it could become a pair.
  void note_out_of_range(std::string_view what, std::string_view text, const FrameCount& side);

  /// Pairs sorted, joined to runs and checked. `protocol`: in words.
  InspectedGroundTruth finish(std::string protocol);

 private:
  void note(FindingKind kind, uint64_t count, const std::string& what);
  bool accept(size_t index, FrameCount& side, std::string_view what);
  void append(size_t query, const GroundTruth::Pair& pair);
  void note_overlaps(size_t query, std::span<const GroundTruth::Pair> kept,
                     const GroundTruth::Pair& pair);
  void join(size_t query);

  const GroundTruthArgument& argument_;
  GroundTruthScope scope_;
  InconsistentPairs inconsistent_;
  Monitor monitor_;
  std::string query_hint_;
  FrameCount query_;
  std::vector<FrameCount> train_;
  std::vector<std::vector<GroundTruth::Pair>> pairs_;
  size_t runs_ = 0;
  FileLocation location_;
  std::array<GroundTruthFinding, 3> findings_;
};

/// The index of the one sequence that was searched. Throws Error(usage) if there are more, or none.
size_t only_written_sequence(const InspectedGroundTruth& ground_truth, std::string_view format);

/// Checks a size before anything is written. Throws Error(data) if there are more than `most` of
/// `what`, such as "pairs".
void require_writable(uint64_t count, uint64_t most, std::string_view what);

/// Writes `text` and empties it once it is long: a query may have a line for every reference.
/// Throws Error(interrupted) on a stop.
void write_piece(Output& file, std::string& text, const Monitor& monitor);

}  // namespace vpr
