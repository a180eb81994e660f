// An output between its making and its place: what commits of one or of many have in common.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>

#include "base/temporary.h"

namespace vpr {

/// What happens to an output that exists already.
enum class Existing { refuse, replace };

/// Throws Error(usage) that offers --force.
[[noreturn]] void refuse_existing(const std::filesystem::path& path);

/// A temporary and where it goes. Steps, in this order: flush, place, and then either take_back or
/// finish. Without finish, the destructor leaves what was there before.
class PendingOutput {
 public:
  /// `check` throws if the target may not be written; it is called before anything is made, and
  /// again before anything is replaced.
  PendingOutput(std::filesystem::path target, Existing existing, Temporary::Kind kind,
                std::function<void()> check);

  const std::filesystem::path& target() const { return target_; }
  const Temporary& temporary() const { return temporary_; }

  void check() const { check_(); }
  void flush() const { temporary_.flush(); }
  /// The temporary gets the target's name. What had that name before gets the temporary's.
  void place();
  /// Undoes place(). False if that can't be done: then both stay as they are.
  bool take_back();
  /// What was there before is removed.
  void finish();

  /// Where the old output is, once it was exchanged.
  std::optional<std::filesystem::path> replaced() const;

 private:
  enum class State { pending, placed, exchanged, finished };

  std::filesystem::path target_;
  Existing existing_;
  std::function<void()> check_;
  Temporary temporary_;
  State state_ = State::pending;
};

/// Puts outputs in their places, all or none: everything is flushed, then each is renamed, in this
/// order, then their folders are flushed, and then what they replace is removed. If a step fails,
/// the old outputs are put back; if that fails, too, the error says what is where. Throws
/// Error(output), or Error(usage) for a target that has come into being meanwhile.
void commit_together(std::span<PendingOutput* const> outputs);

}  // namespace vpr
