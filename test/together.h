// Several processes, played by threads: what they share comes together as it does between machines.
#pragma once

#include <barrier>
#include <functional>
#include <thread>
#include <vector>

#include "base/share.h"

namespace vpr::test {

/// Calls body(share) in `count` threads, each of which is one of as many processes.
inline void run_together(size_t count, const std::function<void(const Share& share)>& body) {
  std::barrier all_here(static_cast<std::ptrdiff_t>(count));
  std::vector<Bytes> given(count);
  std::vector<std::vector<uint64_t>> numbers(count);
  const auto process = [&](size_t index) {
    Share share{index, count};
    share.add = [&, index](std::string_view, std::span<uint64_t> values) {
      numbers[index].assign(values.begin(), values.end());
      all_here.arrive_and_wait();
      for (size_t other = 0; other < count; ++other)
        for (size_t i = 0; other != index && i < values.size(); ++i) values[i] += numbers[other][i];
      all_here.arrive_and_wait();
    };
    share.collect = [&, index](std::string_view, std::span<const std::byte> own) {
      given[index].assign(own.begin(), own.end());
      all_here.arrive_and_wait();
      const std::vector<Bytes> all = index == 0 ? given : std::vector<Bytes>{};
      all_here.arrive_and_wait();
      return all;
    };
    share.spread = [&, index](std::string_view, Bytes& bytes) {
      if (index == 0) given[0] = bytes;
      all_here.arrive_and_wait();
      bytes = given[0];
      all_here.arrive_and_wait();
    };
    body(share);
  };
  std::vector<std::jthread> threads;
  for (size_t index = 0; index < count; ++index) threads.emplace_back(process, index);
}

}  // namespace vpr::test
