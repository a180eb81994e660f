// The bytes of a pickle, from front to back, and the values on its stack.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ground_truth/file_location.h"
#include "ground_truth/pickle.h"

namespace vpr {

/// Every read is checked: Error(data) where the bytes end early.
class PickleInput {
 public:
  PickleInput(std::string_view bytes, FileLocation location)
      : bytes_(bytes), location_(std::move(location)) {}

  size_t size() const { return bytes_.size(); }
  bool at_end() const { return at_ == bytes_.size(); }
  std::string_view take(size_t count);
  /// Little-endian, of up to 8 bytes.
  uint64_t take_number(size_t size);
  /// Without its end.
  std::string_view take_line();
  /// Throws Error(data): "... may be read safely: WHAT (byte 12 of its pickle)".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string_view bytes_;
  FileLocation location_;
  size_t at_ = 0;
};

/// Values, marks between them, and values that were kept for later. Whatever is not there is
/// Error(data).
class PickleStack {
 public:
  explicit PickleStack(const PickleInput& input) : input_(input) {}

  void push(PickleValue value) { values_.push_back(value); }
  void push_integer(int64_t number);
  void push_real(double number);
  void push_mark() { marks_.push_back(values_.size()); }
  PickleValue pop();
  /// The values behind the last mark, which goes, too.
  std::vector<PickleValue> pop_to_mark();
  const PickleValue& top() const;
  /// Keeps the value on top.
  void remember(uint64_t key);
  void remember_next() { remember(memory_.size()); }
  void recall(uint64_t key);
  /// The one value that is left.
  PickleValue only() const;

 private:
  size_t floor() const { return marks_.empty() ? 0 : marks_.back(); }

  const PickleInput& input_;
  std::vector<PickleValue> values_;
  std::vector<size_t> marks_;
  std::unordered_map<uint64_t, PickleValue> memory_;
};

}  // namespace vpr
