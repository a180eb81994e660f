#include "base/pending_output.h"

#include <cerrno>
#include <cstdio>
#include <set>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

// Where the file system has no such flags.
bool lacks_flags(int error_number) {
  return error_number == EINVAL || error_number == ENOSYS || error_number == ENOTSUP;
}

// Renames without replacing; false if something is in the way. File systems without
// RENAME_NOREPLACE get a check before.
bool rename_new(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno == EEXIST) return false;
  if (!lacks_flags(errno)) fail_to_write(to, errno);
  std::error_code error;
  if (fs::exists(fs::symlink_status(to, error))) return false;
  if (::rename(from.c_str(), to.c_str()) != 0) fail_to_write(to, errno);
  return true;
}

// Gives what has a name a second one; where files can't have two, and for folders, another one.
bool set_aside(const fs::path& path, const fs::path& other) {
  return ::link(path.c_str(), other.c_str()) == 0 || ::rename(path.c_str(), other.c_str()) == 0;
}

bool put_back(const fs::path& other, const fs::path& path) {
  if (::rename(other.c_str(), path.c_str()) != 0) return false;
  ::unlink(other.c_str());  // a rename leaves both, if they are names of one file
  return true;
}

// Exchanges two names: in one step where the file system can, in three where it can't. A file's
// name always leads to one of both then; a folder's leads nowhere for a moment, and clean_up puts
// it back if the process is killed then.
void exchange(const fs::path& temporary, const fs::path& target) {
  if (::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0)
    return;
  if (!lacks_flags(errno)) fail_to_write(target, errno);
  const fs::path old = name_aside(temporary);
  if (!set_aside(target, old)) fail_to_write(target, errno);
  const bool is_placed = ::rename(temporary.c_str(), target.c_str()) == 0;
  if (is_placed && ::rename(old.c_str(), temporary.c_str()) == 0) return;
  std::string sentence =
      fmt::format("{}: can't be written: {}", target.string(), system_error_text(errno));
  if (is_placed && ::rename(target.c_str(), temporary.c_str()) != 0)
    sentence += fmt::format("; {} is new, and what it was is {}", target.string(), old.string());
  else if (!put_back(old, target))
    sentence += fmt::format("; what it was is {}", old.string());
  throw Error(ErrorKind::output, sentence);
}

// Takes back what was placed, the last one first; a sentence for each that can't be.
std::string take_back(std::span<PendingOutput* const> placed) {
  std::string left;
  for (size_t i = placed.size(); i-- > 0;) {
    if (placed[i]->take_back()) continue;
    const auto old = placed[i]->replaced();
    left += fmt::format("; {} is new", placed[i]->target().string());
    if (old) left += fmt::format(", and what it was is {}", old->string());
  }
  return left;
}

void flush_folders(std::span<PendingOutput* const> outputs) {
  std::set<fs::path> folders;
  for (const PendingOutput* output : outputs)
    if (folders.insert(folder_of(output->target())).second)
      flush_folder(folder_of(output->target()), output->target());
}

}  // namespace

void refuse_existing(const fs::path& path) {
  throw Error(ErrorKind::usage,
              fmt::format("{}: exists already; give --force to replace it, or another name",
                          path.string()));
}

PendingOutput::PendingOutput(fs::path target, Existing existing, Temporary::Kind kind,
                             std::function<void()> check)
    : target_(std::move(target)),
      existing_(existing),
      check_((clean_up(target_), check(), std::move(check))),
      temporary_(target_, kind) {}

void PendingOutput::place() {
  if (rename_new(temporary_.path(), target_)) {
    state_ = State::placed;
    return;
  }
  if (existing_ == Existing::refuse) refuse_existing(target_);
  exchange(temporary_.path(), target_);
  state_ = State::exchanged;
}

bool PendingOutput::take_back() {
  try {
    bool is_back = true;
    if (state_ == State::exchanged)
      exchange(temporary_.path(), target_);
    else
      is_back = rename_new(target_, temporary_.path());
    if (is_back) state_ = State::pending;
  } catch (const Error&) {
  }
  if (state_ != State::pending) temporary_.give_up();
  return state_ == State::pending;
}

void PendingOutput::finish() {
  if (state_ == State::placed) temporary_.give_up();
  state_ = State::finished;
}

std::optional<fs::path> PendingOutput::replaced() const {
  return state_ == State::exchanged ? std::optional(temporary_.path()) : std::nullopt;
}

void commit_together(std::span<PendingOutput* const> outputs) {
  for (const PendingOutput* output : outputs) output->check();
  for (const PendingOutput* output : outputs) output->flush();
  size_t placed = 0;
  try {
    for (; placed < outputs.size(); ++placed) outputs[placed]->place();
    flush_folders(outputs);
  } catch (const Error& error) {
    throw Error(error.kind(), error.what() + take_back(outputs.first(placed)));
  }
  for (PendingOutput* output : outputs) output->finish();
}

}  // namespace vpr
