// Where in a file a reader is.
#pragma once

#include <string>
#include <string_view>

namespace vpr {

/// A file and a line or row of it, for errors.
struct FileLocation {
  std::string file;
  std::string_view unit = {};  ///< "line" or "row"; empty: the file as a whole
  size_t number = 0;

  void at(std::string_view new_unit, size_t new_number) {
    unit = new_unit;
    number = new_number;
  }
  /// "poses.csv, line 3".
  std::string text() const;
  /// Throws Error(data): "poses.csv, line 3: WHAT".
  [[noreturn]] void fail(std::string_view what) const;
};

}  // namespace vpr
