#include "images/growing_folder.h"

#include <array>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "base/error.h"
#include "images/decode.h"
#include "images/sequence.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr int kPatienceMs = 50;                // how long a stop may wait
constexpr std::chrono::seconds kLookEvery(1);  // at a folder that may tell nothing

Error gone(const fs::path& folder, const std::string& why) {
  return {ErrorKind::input, fmt::format("{}: can't be read: {}", folder.string(), why)};
}

}  // namespace

GrowingFolder::GrowingFolder(const fs::path& folder, std::chrono::milliseconds rest)
    : folder_(folder), rest_for_(rest), changed_(fs::file_time_type::min()) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw gone(folder, "is no folder");
  // Before the folder is looked at for the first time: nothing is missed between.
  events_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (events_ < 0) return;
  if (::inotify_add_watch(events_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE) < 0) {
    ::close(events_);
    events_ = -1;
  }
}

GrowingFolder::~GrowingFolder() {
  if (events_ >= 0) ::close(events_);
}

void GrowingFolder::look() {
  const Clock::time_point now = Clock::now();
  if (looked_ && now - *looked_ < kLookEvery) return;
  looked_ = now;
  std::error_code error;
  const fs::file_time_type changed = fs::last_write_time(folder_, error);
  if (error) throw gone(folder_, error.message());
  if (changed == changed_) return;
  changed_ = changed;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (is_frame_name(name) && is_later(name)) waiting_.insert(name);
  }
  if (error) throw gone(folder_, error.message());
}

bool GrowingFolder::is_later(const std::string& name) const {
  return last_.empty() || natural_less(last_, name);
}

void GrowingFolder::take_event(const std::string& name, uint32_t event, const Monitor& monitor) {
  if (!is_frame_name(name)) return;
  if (is_later(name)) {
    waiting_.insert(name);
    if ((event & IN_MOVED_TO) != 0) renamed_.insert(name);
    if ((event & IN_CLOSE_WRITE) != 0) closed_.insert(name);
  } else if (natural_less(name, last_) && (event & IN_CLOSE_WRITE) == 0) {
    warn(monitor, fmt::format("{}: came after {}, which was taken before, and is left out",
                              (folder_ / name).string(), last_));
  }
}

void GrowingFolder::read_events(const Monitor& monitor) {
  alignas(inotify_event) std::array<char, 16384> buffer;
  while (events_ >= 0) {
    const ssize_t bytes = ::read(events_, buffer.data(), buffer.size());
    if (bytes <= 0) return;
    for (ssize_t at = 0; at < bytes;) {
      inotify_event event;
      std::memcpy(&event, buffer.data() + at, sizeof(event));
      at += static_cast<ssize_t>(sizeof(event));
      if (event.len > 0) take_event(buffer.data() + at, event.mask, monitor);
      at += event.len;
    }
  }
}

bool GrowingFolder::has_rested(const std::string& name) {
  std::error_code error;
  const uintmax_t size = fs::file_size(folder_ / name, error);
  const Clock::time_point now = Clock::now();
  if (error) {  // it is gone again
    waiting_.erase(name);
    resting_.reset();
    return false;
  }
  if (!resting_ || resting_->name != name || resting_->size != size) resting_ = {name, size, now};
  return size > 0 && now - resting_->since >= rest_for_;
}

bool GrowingFolder::can_be_decoded(const std::string& name, const Monitor& monitor) {
  try {
    decode_image(folder_ / name, PixelFormat::grey);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) return true;
    closed_.erase(name);
    resting_.reset();
    if (std::exchange(incomplete_, name) != name)
      warn(monitor, fmt::format("{}: is incomplete; waiting for the rest of it, or a later image",
                                (folder_ / name).string()));
    return false;
  }
  return true;
}

bool GrowingFolder::is_complete(const std::string& name, const Monitor& monitor) {
  if (renamed_.contains(name) || waiting_.size() > 1) return true;
  return (closed_.contains(name) || has_rested(name)) && can_be_decoded(name, monitor);
}

void GrowingFolder::wait() const {
  pollfd events{events_, POLLIN, 0};  // a negative one is passed over
  ::poll(&events, 1, kPatienceMs);
}

fs::path GrowingFolder::next(const Monitor& monitor) {
  for (;; wait()) {
    check_stop(monitor);
    read_events(monitor);
    look();
    if (waiting_.empty()) continue;
    const std::string name = *waiting_.begin();
    if (!is_complete(name, monitor)) continue;
    waiting_.erase(name);
    renamed_.erase(name);
    closed_.erase(name);
    last_ = name;
    return folder_ / name;
  }
}

}  // namespace vpr
