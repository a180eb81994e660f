// Work that several processes do together: which part is this one's, and how parts come together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace vpr {

using Bytes = std::vector<std::byte>;

/// One of `count` processes that take the same steps in the same order. A step is a call of one of
/// the functions below, by all of them from their main thread; `what` names it in reports. They
/// throw the Error of another process that has failed meanwhile. Alone, nothing is called.
struct Share {
  size_t index = 0;
  size_t count = 1;
  /// Values become the sums of those of all processes.
  std::function<void(std::string_view what, std::span<uint64_t> values)> add = {};
  /// What each process gives, in the order of processes, in the first one; nothing in the others.
  std::function<std::vector<Bytes>(std::string_view what, std::span<const std::byte> own)> collect =
      {};
  /// What the first process has, in all of them.
  std::function<void(std::string_view what, Bytes& bytes)> spread = {};

  bool is_first() const { return index == 0; }
  bool is_alone() const { return count == 1; }
};

/// Items [first, last) of some.
struct ItemRange {
  size_t first = 0;
  size_t last = 0;

  size_t count() const { return last - first; }
  bool contains(size_t item) const { return item >= first && item < last; }
  bool operator==(const ItemRange&) const = default;
};

/// This process's of `items`: parts differ by one item at most, and follow each other.
inline ItemRange own_part(const Share& share, size_t items) {
  const auto bound = [&](size_t index) {
    return items / share.count * index + items % share.count * index / share.count;
  };
  return {bound(share.index), bound(share.index + 1)};
}

template <class T>
std::vector<T> values_of(std::span<const std::byte> bytes) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// What all processes give, one after the other, in the first one; nothing in the others.
template <class T>
std::vector<T> collected(const Share& share, std::string_view what, const std::vector<T>& own) {
  if (share.is_alone()) return own;
  std::vector<T> all;
  for (const Bytes& part : share.collect(what, std::as_bytes(std::span(own)))) {
    const std::vector<T> values = values_of<T>(part);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

/// What the first process has, in all of them.
template <class T>
std::vector<T> spread(const Share& share, std::string_view what, std::vector<T> of_first) {
  if (share.is_alone()) return of_first;
  const auto bytes = std::as_bytes(std::span(of_first));
  Bytes told(bytes.begin(), bytes.end());
  share.spread(what, told);
  return values_of<T>(told);
}

/// What the first process makes, in all of them: the others wait, for it can't be shared.
template <class Make>
auto made_by_first(const Share& share, std::string_view what, Make&& make) {
  using Made = decltype(make());
  return spread(share, what, share.is_first() ? make() : Made{});
}

/// Ends all processes with an Error(usage) unless all of them have the same text. A step.
inline void check_same(const Share& share, std::string_view what, const std::string& own) {
  if (share.is_alone()) return;
  const auto mine = std::as_bytes(std::span(own));
  for (const Bytes& other : share.collect(what, mine))
    if (!std::equal(mine.begin(), mine.end(), other.begin(), other.end()))
      throw Error(ErrorKind::usage,
                  "the processes that mpirun started have different " + std::string(what) +
                      "; start all of them with one command line, and with the same files");
}

/// Sums over all processes, in each of them.
inline void add_up(const Share& share, std::string_view what, std::span<uint64_t> values) {
  if (!share.is_alone()) share.add(what, values);
}

}  // namespace vpr
