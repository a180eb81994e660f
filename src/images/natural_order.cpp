#include "images/natural_order.h"

#include <algorithm>
#include <cstddef>

namespace vpr {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Cuts the digits at the front of `text` off; of any length, so no number type is involved.
std::string_view take_digits(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
  const std::string_view digits(text.data(), static_cast<size_t>(end - text.begin()));
  text.remove_prefix(digits.size());
  return digits;
}

std::string_view without_leading_zeros(std::string_view digits) {
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

// Negative, 0 or positive. std::string_view compares as unsigned bytes.
int compare_values(std::string_view a, std::string_view b) {
  a = without_leading_zeros(a);
  b = without_leading_zeros(b);
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  bool fewer_zeros = false;
  bool decided = false;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = take_digits(a);
      const std::string_view number_b = take_digits(b);
      const int order = compare_values(number_a, number_b);
      if (order != 0) return order < 0;
      if (!decided && number_a.size() != number_b.size()) {
        decided = true;
        fewer_zeros = number_a.size() < number_b.size();
      }
    } else {
      const int order = a.substr(0, 1).compare(b.substr(0, 1));
      if (order != 0) return order < 0;
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() && b.empty()) return fewer_zeros;
  return a.empty();
}

}  // namespace vpr
