// The module that knows MPI, by its C interface. Only the main thread calls it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <thread>

#include <fmt/format.h>
#include <mpi.h>

#include "base/stopwatch.h"
#include "cluster/process_group.h"

namespace vpr {
namespace {

constexpr size_t kMostAtOnce = size_t{1} << 28;  // of bytes or numbers: MPI counts by int
constexpr int64_t kEnd = -1;
constexpr int64_t kAnyStep = std::numeric_limits<int64_t>::min();

struct Traffic {
  uint64_t steps = 0;
  uint64_t bytes = 0;  ///< that this process has given
};

class MpiGroup : public ProcessGroup {
 public:
  explicit MpiGroup(const std::atomic<bool>& stop) : stop_(stop) {
    MPI_Comm_rank(MPI_COMM_WORLD, &index_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
  }

  Share share() override {
    Share share{static_cast<size_t>(index_), static_cast<size_t>(count_)};
    share.add = [this](std::string_view what, std::span<uint64_t> values) {
      begin_step(what, values.size_bytes());
      reduce(values, MPI_UINT64_T, MPI_SUM);
    };
    share.collect = [this](std::string_view what, std::span<const std::byte> own) {
      begin_step(what, index_ == 0 ? 0 : own.size());
      return collect(own);
    };
    share.spread = [this](std::string_view what, Bytes& bytes) {
      begin_step(what, index_ == 0 ? bytes.size() * static_cast<size_t>(count_ - 1) : 0);
      spread(0, bytes);
    };
    return share;
  }

  std::vector<std::string> report() override {
    const std::vector<double> own = {since_start_.elapsed_s(), waited_s_};
    const std::map<std::string, Traffic> traffic = traffic_;
    const std::vector<double> seconds = collected(share(), "report", own);
    std::vector<uint64_t> bytes;
    for (const auto& [what, of] : traffic) bytes.push_back(of.bytes);
    add_up(share(), "report", bytes);
    std::vector<std::string> lines;
    for (size_t i = 0; 2 * i < seconds.size(); ++i)
      lines.push_back(fmt::format("process {}: {:.3f} s, of which it waited {:.3f} s", i,
                                  seconds[2 * i], seconds[2 * i + 1]));
    auto sum = bytes.begin();
    for (const auto& [what, of] : traffic)
      lines.push_back(fmt::format("sent {}: {} bytes in {} steps", what, *sum++, of.steps));
    return lines;
  }

  void end() override { agree(kEnd, nullptr); }

  Error fail(const Error& own) override {
    if (agreed_) return *agreed_;
    is_cut_ = true;
    if (own.kind() == ErrorKind::interrupted) return own;
    try {
      agree(kAnyStep, &own);
    } catch (const Error& error) {
      is_cut_ = !agreed_;
      return error;
    }
    return own;
  }

  void close(int exit_code) override {
    if (is_cut_) {  // nobody may listen
      std::fflush(nullptr);
      std::_Exit(exit_code);
    }
    MPI_Barrier(MPI_COMM_WORLD);
    MPI_Finalize();
  }

 private:
  // The lowest process that failed says why, all others at which step they are.
  void agree(int64_t step, const Error* failure) {
    int64_t states[] = {failure == nullptr ? 0 : count_ - index_, step,
                        step == kAnyStep ? kAnyStep : -step};
    reduce(std::span<int64_t>(states), MPI_INT64_T, MPI_MAX);
    if (states[0] > 0) {
      std::string text;
      if (failure != nullptr)
        text = static_cast<char>(failure->kind()) + std::string(failure->what());
      const auto own = std::as_bytes(std::span(text));
      Bytes told(own.begin(), own.end());
      spread(count_ - static_cast<int>(states[0]), told);
      text.assign(reinterpret_cast<const char*>(told.data()), told.size());
      agreed_.emplace(static_cast<ErrorKind>(text[0]), text.substr(1));
    } else if (states[1] != -states[2]) {
      agreed_.emplace(ErrorKind::internal, "the processes of mpirun took different steps");
    }
    if (agreed_) throw Error(*agreed_);
  }

  void begin_step(std::string_view what, uint64_t bytes) {
    Traffic& traffic = traffic_[std::string(what)];
    ++traffic.steps;
    traffic.bytes += bytes;
    agree(++steps_, nullptr);
  }

  std::vector<Bytes> collect(std::span<const std::byte> own) {
    std::vector<uint64_t> sizes(static_cast<size_t>(count_), 0);
    sizes[static_cast<size_t>(index_)] = own.size();
    reduce(std::span(sizes), MPI_UINT64_T, MPI_SUM);
    if (index_ > 0) {
      in_parts(own, [](const std::byte* part, int size, MPI_Request* request) {
        MPI_Isend(part, size, MPI_BYTE, 0, 0, MPI_COMM_WORLD, request);
      });
      return {};
    }
    std::vector<Bytes> all = {Bytes(own.begin(), own.end())};
    for (int from = 1; from < count_; ++from)
      in_parts(std::span(all.emplace_back(sizes[static_cast<size_t>(from)])),
               [from](std::byte* part, int size, MPI_Request* request) {
                 MPI_Irecv(part, size, MPI_BYTE, from, 0, MPI_COMM_WORLD, request);
               });
    return all;
  }

  void spread(int from, Bytes& bytes) {
    uint64_t size = index_ == from ? bytes.size() : 0;
    reduce(std::span(&size, 1), MPI_UINT64_T, MPI_SUM);
    bytes.resize(size);
    in_parts(std::span(bytes), [from](std::byte* part, int count, MPI_Request* request) {
      MPI_Ibcast(part, count, MPI_BYTE, from, MPI_COMM_WORLD, request);
    });
  }

  template <class T>
  void reduce(std::span<T> values, MPI_Datatype type, MPI_Op how) {
    in_parts(values, [=](T* part, int size, MPI_Request* request) {
      MPI_Iallreduce(MPI_IN_PLACE, part, size, type, how, MPI_COMM_WORLD, request);
    });
  }

  template <class T, class Start>
  void in_parts(std::span<T> values, Start&& start) {
    // The analyzer knows MPI_Wait alone, and these requests are waited for by MPI_Test.
    // NOLINTNEXTLINE(clang-analyzer-optin.mpi.MPI-Checker)
    for (size_t first = 0; first < values.size(); first += kMostAtOnce) {
      MPI_Request request = MPI_REQUEST_NULL;
      start(values.data() + first, static_cast<int>(std::min(kMostAtOnce, values.size() - first)),
            &request);
      wait(request);
    }
  }

  // Not by MPI_Wait, which can't be ended and keeps a processor busy that others may need: a short
  // wait stays short, a long one costs next to nothing.
  void wait(MPI_Request& request) {
    constexpr int kMostPause_us = 1000;
    const Stopwatch watch;
    int is_done = 0;
    for (int pause_us = 0;; pause_us = std::min(pause_us + 1, kMostPause_us)) {
      MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
      if (is_done != 0) break;
      if (stop_.load(std::memory_order_relaxed))
        throw Error(ErrorKind::interrupted, "interrupted; nothing was written");
      std::this_thread::sleep_for(std::chrono::microseconds(pause_us));
    }
    waited_s_ += watch.elapsed_s();
  }

  const std::atomic<bool>& stop_;
  int index_ = 0;
  int count_ = 1;
  std::optional<Error> agreed_;  ///< the failure that ends all
  bool is_cut_ = false;
  std::map<std::string, Traffic> traffic_;
  int64_t steps_ = 0;
  double waited_s_ = 0;
  Stopwatch since_start_;
};

}  // namespace
}  // namespace vpr

extern "C" vpr::ProcessGroup* vpr_open_group(const std::atomic<bool>& stop) {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED,
                  &provided);  // ends the process if it fails
  return new vpr::MpiGroup(stop);
}
