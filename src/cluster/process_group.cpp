#include "cluster/process_group.h"

#include <cstdlib>
#include <filesystem>
#include <thread>

#include <dlfcn.h>
#include <fmt/format.h>

namespace vpr {
namespace {

constexpr int64_t kEnd = -1;
constexpr int64_t kAnyStep = std::numeric_limits<int64_t>::min();

// What the wait of this process looks at; set once, before the channel is opened.
const std::atomic<bool>* stop_wanted = nullptr;
double waited_s = 0;

// Other processes may share the processor: a short wait stays short, a long one costs nothing.
void while_waiting() {
  static Stopwatch since_last;
  static double pause_us = 0;
  if (stop_wanted->load(std::memory_order_relaxed))
    throw Error(ErrorKind::interrupted,
                "interrupted, by the user or the end of another process; nothing was written");
  const double since_last_us = since_last.elapsed_s() * 1e6;
  constexpr double kNewWait_us = 50;
  constexpr double kLongest_us = 1000;
  pause_us = since_last_us > kNewWait_us + 2 * pause_us ? 0 : std::min(pause_us + 1, kLongest_us);
  const Stopwatch pause;
  std::this_thread::sleep_for(std::chrono::microseconds(static_cast<int64_t>(pause_us)));
  waited_s += pause.elapsed_s();
  since_last = {};
}

std::optional<uint64_t> number_of(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr || *text == 0) return std::nullopt;
  return std::strtoull(text, nullptr, 10);
}

// Beside the folder of the programs, built or installed.
Channel* open_channel() {
  const std::filesystem::path module =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / VPR_CLUSTER_MODULE;
  void* library = ::dlopen(module.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (library == nullptr && !std::filesystem::exists(module))
    throw Error(ErrorKind::usage,
                "started by mpirun, but built without MPI: install libopenmpi-dev and build "
                "again, or leave mpirun out");
  if (library == nullptr) throw Error(ErrorKind::input, fmt::format("can't load {}", ::dlerror()));
  const auto open = reinterpret_cast<OpenChannel>(::dlsym(library, kOpenChannel));
  Channel* channel = open == nullptr ? nullptr : open(while_waiting);
  if (channel == nullptr) throw Error(ErrorKind::input, "MPI can't connect the processes");
  return channel;
}

}  // namespace

std::optional<size_t> launched_index() {
  for (const auto& [count, index] : {std::pair("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"),
                                     std::pair("PMI_SIZE", "PMI_RANK")})
    if (const auto processes = number_of(count))
      return *processes > 1 ? std::optional(number_of(index).value_or(0)) : std::nullopt;
  return number_of("PMIX_RANK");
}

ProcessGroup::ProcessGroup(const std::atomic<bool>& stop) {
  stop_wanted = &stop;
  channel_.reset(open_channel());
}

ProcessGroup::~ProcessGroup() = default;

Share ProcessGroup::share() {
  Share share{channel_->index(), channel_->count()};
  share.add = [this](std::string_view what, std::span<uint64_t> values) {
    begin_step(what, values.size_bytes());
    channel_->add(values);
  };
  share.collect = [this](std::string_view what, std::span<const std::byte> own) {
    begin_step(what, channel_->index() == 0 ? 0 : own.size());
    return collect(own);
  };
  share.spread = [this](std::string_view what, Bytes& bytes) {
    begin_step(what, channel_->index() == 0 ? bytes.size() * (channel_->count() - 1) : 0);
    spread(0, bytes);
  };
  return share;
}

void ProcessGroup::end() { agree(kEnd, nullptr); }

Error ProcessGroup::fail(const Error& own) {
  if (agreed_) return *agreed_;
  is_cut_ = true;
  if (own.kind() == ErrorKind::interrupted) return own;
  try {
    agree(kAnyStep, &own);
  } catch (const Error& error) {
    if (!agreed_) return error;
  }
  is_cut_ = false;
  return *agreed_;
}

void ProcessGroup::close() {
  if (is_cut_) return;
  try {
    int64_t nothing = 0;
    channel_->most({&nothing, 1});
    channel_->close();
  } catch (const Error&) {  // interrupted when all was done
  }
}

// The lowest process that failed says why, all others at which step they are.
void ProcessGroup::agree(int64_t step, const Error* failure) {
  const auto count = static_cast<int64_t>(channel_->count());
  int64_t states[] = {failure == nullptr ? 0 : count - static_cast<int64_t>(channel_->index()),
                      step, step == kAnyStep ? kAnyStep : -step};
  channel_->most(states);
  if (states[0] > 0) {
    Bytes told;
    if (failure != nullptr) {
      const std::string text =
          static_cast<char>(failure->kind()) + std::string(failure->what());
      const auto bytes = std::as_bytes(std::span(text));
      told.assign(bytes.begin(), bytes.end());
    }
    spread(static_cast<size_t>(count - states[0]), told);
    const std::string text(reinterpret_cast<const char*>(told.data()), told.size());
    agreed_.emplace(static_cast<ErrorKind>(text[0]), text.substr(1));
  } else if (states[1] != -states[2]) {
    agreed_.emplace(ErrorKind::internal, "the processes of mpirun took different steps");
  }
  if (agreed_) throw Error(*agreed_);
}

void ProcessGroup::begin_step(std::string_view what, uint64_t bytes) {
  Traffic& traffic = traffic_[std::string(what)];
  ++traffic.steps;
  traffic.bytes += bytes;
  agree(++steps_, nullptr);
}

std::vector<Bytes> ProcessGroup::collect(std::span<const std::byte> own) {
  std::vector<uint64_t> sizes(channel_->count(), 0);
  sizes[channel_->index()] = own.size();
  channel_->add(sizes);
  if (channel_->index() > 0) {
    channel_->send(own);
    return {};
  }
  std::vector<Bytes> all = {Bytes(own.begin(), own.end())};
  for (size_t from = 1; from < sizes.size(); ++from)
    channel_->receive(from, all.emplace_back(sizes[from]));
  return all;
}

void ProcessGroup::spread(size_t from, Bytes& bytes) {
  uint64_t size = channel_->index() == from ? bytes.size() : 0;
  channel_->add({&size, 1});
  bytes.resize(size);
  channel_->spread(from, bytes);
}

std::vector<std::string> ProcessGroup::report() {
  const std::vector<double> times = {since_start_.elapsed_s(), waited_s};
  const std::map<std::string, Traffic, std::less<>> traffic = traffic_;
  const Share all = share();
  const std::vector<double> seconds = collected(all, "report", times);
  std::vector<uint64_t> given;
  for (const auto& [what, of] : traffic) given.push_back(of.bytes);
  add_up(all, "report", given);
  std::vector<std::string> lines;
  for (size_t i = 0; 2 * i < seconds.size(); ++i)
    lines.push_back(fmt::format("process {}: {:.3f} s, of which it waited {:.3f} s", i,
                                seconds[2 * i], seconds[2 * i + 1]));
  size_t i = 0;
  for (const auto& [what, of] : traffic)
    lines.push_back(fmt::format("sent {}: {} bytes in {} steps", what, given[i++], of.steps));
  return lines;
}

}  // namespace vpr
