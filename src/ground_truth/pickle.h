// Python pickles that hold NumPy arrays of objects: parsed, never executed.
//
// A pickle is a program for a stack machine that may call any function. Only the instructions that
// build lists, tuples, numbers, texts and NumPy arrays are known here, and only the functions that
// NumPy itself uses to rebuild an array; everything else is refused. Source: the documentation of
// Python's pickletools, and NumPy's ndarray.__reduce__.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ground_truth/file_location.h"

namespace vpr {

enum class PickleKind : uint8_t {
  none,
  integer,  ///< and bool
  real,
  text,   ///< text or bytes
  list,   ///< list or tuple
  range,  ///< Python's range: three integers
  global,
  type,  ///< a NumPy dtype
  array  ///< a NumPy array
};

/// A number, or the index of something larger.
struct PickleValue {
  PickleKind kind = PickleKind::none;
  union {
    int64_t integer = 0;
    double real;
    size_t index;
  };
};

struct PickleObject {
  std::vector<PickleValue> items;  ///< of a list or range; of an array of objects, their one list
  std::string_view text;           ///< of a text, the name of a global or type, numbers of an array
  std::vector<size_t> shape;       ///< of an array
  std::string type;                ///< of an array: "O", "i8", "u1", "f8", ...
};

class Pickle {
 public:
  /// `bytes` must outlive it. Throws Error(data), naming `location` and the byte, if it is damaged
  /// or does anything but rebuild such an array.
  Pickle(std::string_view bytes, const FileLocation& location);

  const PickleValue& root() const { return root_; }
  const PickleObject& object(const PickleValue& value) const { return objects_[value.index]; }
  /// The objects of an array of objects.
  const std::vector<PickleValue>& elements(const PickleObject& array) const {
    return object(array.items.front()).items;
  }

  /// How many elements a list, tuple, range or one-dimensional array has; nothing for anything
  /// else. Never more than the bytes of the file, but of a range.
  std::optional<uint64_t> length(const PickleValue& value) const;
  /// Element i of one, if it is a whole number (a real one like 3.0, too).
  std::optional<int64_t> whole_number(const PickleValue& value, uint64_t i) const;
  /// The number that a value is.
  static std::optional<int64_t> whole_number(const PickleValue& value);

 private:
  friend class PickleMachine;

  std::deque<std::string> texts_;  // those that don't stand in the file as they are
  std::vector<PickleObject> objects_;
  PickleValue root_;
};

}  // namespace vpr
