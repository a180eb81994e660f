// The module that knows MPI, by its C interface. Only the main thread calls it.
#include <algorithm>

#include <mpi.h>

#include "cluster/channel.h"

namespace vpr {
namespace {

constexpr size_t kMostAtOnce = size_t{1} << 28;  // of bytes or numbers: MPI counts by int

class MpiChannel : public Channel {
 public:
  explicit MpiChannel(void (*while_waiting)()) : while_waiting_(while_waiting) {
    MPI_Comm_rank(MPI_COMM_WORLD, &index_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
  }
  size_t index() const override { return static_cast<size_t>(index_); }
  size_t count() const override { return static_cast<size_t>(count_); }

  void add(std::span<uint64_t> values) override {
    in_parts(values, [](uint64_t* part, int size, MPI_Request* request) {
      MPI_Iallreduce(MPI_IN_PLACE, part, size, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD, request);
    });
  }
  void most(std::span<int64_t> values) override {
    in_parts(values, [](int64_t* part, int size, MPI_Request* request) {
      MPI_Iallreduce(MPI_IN_PLACE, part, size, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD, request);
    });
  }
  void spread(size_t from, std::span<std::byte> bytes) override {
    in_parts(bytes, [from](std::byte* part, int size, MPI_Request* request) {
      MPI_Ibcast(part, size, MPI_BYTE, static_cast<int>(from), MPI_COMM_WORLD, request);
    });
  }
  void send(std::span<const std::byte> bytes) override {
    in_parts(bytes, [](const std::byte* part, int size, MPI_Request* request) {
      MPI_Isend(part, size, MPI_BYTE, 0, 0, MPI_COMM_WORLD, request);
    });
  }
  void receive(size_t from, std::span<std::byte> bytes) override {
    in_parts(bytes, [from](std::byte* part, int size, MPI_Request* request) {
      MPI_Irecv(part, size, MPI_BYTE, static_cast<int>(from), 0, MPI_COMM_WORLD, request);
    });
  }
  void close() override { MPI_Finalize(); }

 private:
  template <class T, class Start>
  void in_parts(std::span<T> values, Start&& start) const {
    for (size_t first = 0; first < values.size(); first += kMostAtOnce) {
      MPI_Request request = MPI_REQUEST_NULL;
      start(values.data() + first, static_cast<int>(std::min(kMostAtOnce, values.size() - first)),
            &request);
      wait(request);
    }
  }

  // Not by MPI_Wait, which can't be ended and keeps a processor busy that others may need.
  void wait(MPI_Request& request) const {
    int is_done = 0;
    for (MPI_Test(&request, &is_done, MPI_STATUS_IGNORE); is_done == 0;
         MPI_Test(&request, &is_done, MPI_STATUS_IGNORE))
      while_waiting_();
  }

  void (*while_waiting_)();
  int index_ = 0;
  int count_ = 1;
};

}  // namespace
}  // namespace vpr

extern "C" vpr::Channel* vpr_open_channel(void (*while_waiting)()) {
  int provided = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS)
    return nullptr;
  return new vpr::MpiChannel(while_waiting);
}
