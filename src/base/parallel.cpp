#include "base/parallel.h"

#include <algorithm>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

namespace vpr {

void parallel_for(size_t count, const Monitor& monitor, const std::function<void(size_t)>& body) {
  const auto part_of = [&](size_t i) {
    const ThreadOrder::Part part;
    check_stop(monitor);
    body(i);
  };
  const ThreadOrder order;
  oneapi::tbb::parallel_for(size_t{0}, count, part_of);
}

size_t thread_count() {
  const auto limit = oneapi::tbb::global_control::active_value(
      oneapi::tbb::global_control::max_allowed_parallelism);
  return std::min<size_t>(limit, static_cast<size_t>(oneapi::tbb::info::default_concurrency()));
}

ThreadLimit::ThreadLimit(size_t threads) {
  if (threads == 0) threads = static_cast<size_t>(oneapi::tbb::info::default_concurrency());
  control_ = std::make_shared<oneapi::tbb::global_control>(
      oneapi::tbb::global_control::max_allowed_parallelism, threads);
}

}  // namespace vpr
