#include "ground_truth/pickle_input.h"

#include <fmt/format.h>

namespace vpr {

void PickleInput::fail(const std::string& what) const {
  location_.fail(fmt::format(
      "is no NumPy array of objects that may be read safely: {} (byte {} of its pickle)", what,
      at_));
}

std::string_view PickleInput::take(size_t count) {
  if (count > bytes_.size() - at_) fail("it ends early");
  const std::string_view taken = bytes_.substr(at_, count);
  at_ += count;
  return taken;
}

uint64_t PickleInput::take_number(size_t size) {
  uint64_t value = 0;
  const std::string_view raw = take(size);
  for (size_t i = 0; i < size; ++i) value |= uint64_t{static_cast<uint8_t>(raw[i])} << (8 * i);
  return value;
}

std::string_view PickleInput::take_line() {
  const size_t end = bytes_.find('\n', at_);
  if (end == std::string_view::npos) fail("it ends early");
  const std::string_view line = take(end - at_);
  take(1);
  return line;
}

void PickleStack::push_integer(int64_t number) {
  PickleValue value;
  value.kind = PickleKind::integer;
  value.integer = number;
  push(value);
}

void PickleStack::push_real(double number) {
  PickleValue value;
  value.kind = PickleKind::real;
  value.real = number;
  push(value);
}

const PickleValue& PickleStack::top() const {
  if (values_.size() <= floor()) input_.fail("a value is missing");
  return values_.back();
}

PickleValue PickleStack::pop() {
  const PickleValue value = top();
  values_.pop_back();
  return value;
}

std::vector<PickleValue> PickleStack::pop_to_mark() {
  if (marks_.empty()) input_.fail("a mark is missing");
  const auto first = values_.begin() + static_cast<ptrdiff_t>(marks_.back());
  std::vector<PickleValue> items(first, values_.end());
  values_.erase(first, values_.end());
  marks_.pop_back();
  return items;
}

void PickleStack::remember(uint64_t key) {
  constexpr size_t kMostKept = size_t{1} << 22;
  if (memory_.size() == kMostKept) input_.fail("it keeps too many values");
  memory_[key] = top();
}

void PickleStack::recall(uint64_t key) {
  const auto found = memory_.find(key);
  if (found == memory_.end()) input_.fail("it recalls a value that was not kept");
  push(found->second);
}

PickleValue PickleStack::only() const {
  if (values_.size() != 1 || !marks_.empty()) input_.fail("it leaves more than one value");
  return values_.front();
}

}  // namespace vpr
