#include "base/error.h"

#include <system_error>

namespace vpr {

int exit_code(ErrorKind kind) {
  constexpr int kCodes[] = {2, 3, 3, 4, 5, 130, 1};  // in the order of ErrorKind
  return kCodes[static_cast<size_t>(kind)];
}

void require_range(std::string_view setting, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw Error(ErrorKind::usage, "{} must be from {} to {}, found {}", setting, low, high, value);
}

std::string system_error_text(int error_number) {
  return std::generic_category().message(error_number);
}

}  // namespace vpr
