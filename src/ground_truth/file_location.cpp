#include "ground_truth/file_location.h"

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {

std::string FileLocation::text() const {
  return unit.empty() ? file : fmt::format("{}, {} {}", file, unit, number);
}

void FileLocation::fail(std::string_view what) const {
  throw Error(ErrorKind::data, fmt::format("{}: {}", text(), what));
}

}  // namespace vpr
