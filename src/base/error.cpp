#include "base/error.h"

#include <system_error>

namespace vpr {

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return 2;
    case ErrorKind::input:
    case ErrorKind::output:
      return 3;
    case ErrorKind::data:
      return 4;
    case ErrorKind::expectation:
      return 5;
    case ErrorKind::interrupted:
      return 130;
    case ErrorKind::internal:
      break;
  }
  return 1;
}

std::string system_error_text(int error_number) {
  return std::generic_category().message(error_number);
}

}  // namespace vpr
