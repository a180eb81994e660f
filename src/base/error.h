// The toolkit's only exception type: a kind, which determines the exit code, and a message.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace vpr {

/// The cause of an error; the programs map it to their exit code.
enum class ErrorKind {
  usage,        ///< wrong flags or settings, or an existing output (exit code 2)
  input,        ///< a file is missing or cannot be decoded (3)
  output,       ///< a file cannot be written (3)
  data,         ///< a database, result or ground truth is damaged or does not match (4)
  expectation,  ///< a check that the user requested failed (5)
  interrupted,  ///< the user stopped the program (130)
  internal      ///< a defect in the toolkit (1)
};

/// The message says what is wrong, where, and what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  template <class First, class... Rest>
  Error(ErrorKind kind, fmt::format_string<First, Rest...> message, First&& first, Rest&&... rest)
      : Error(kind, fmt::format(message, std::forward<First>(first), std::forward<Rest>(rest)...)) {
  }
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

constexpr int exit_code(ErrorKind kind) {
  constexpr int kCodes[] = {2, 3, 3, 4, 5, 130, 1};  // in the order of ErrorKind
  return kCodes[static_cast<size_t>(kind)];
}

/// Throws Error(usage), which names the setting, unless low <= value <= high.
inline void require_range(std::string_view setting, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw Error(ErrorKind::usage, "{} must be from {} to {}, found {}", setting, low, high, value);
}

/// The system's text for an errno value, such as "No space left on device". Thread-safe.
inline std::string system_error_text(int error_number) {
  return std::generic_category().message(error_number);
}

}  // namespace vpr
