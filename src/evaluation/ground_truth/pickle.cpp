#include "evaluation/ground_truth/pickle.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include <fmt/format.h>

namespace vpr {
namespace {

constexpr size_t kMaxBytes = size_t{1} << 28;
/// Arguments of any function here, and extents of an array. A longer list could be copied by every
/// few bytes of a hostile file.
constexpr size_t kMostArguments = 32;

/// What the functions that may be called are known as.
enum class Function { reconstruct, ndarray, dtype, scalar, encode, range };

struct Global {
  std::string_view name;  // module, a space, and the name
  Function function;
};

constexpr std::array<Global, 9> kGlobals = {{
    {"numpy.core.multiarray _reconstruct", Function::reconstruct},
    {"numpy._core.multiarray _reconstruct", Function::reconstruct},
    {"numpy ndarray", Function::ndarray},
    {"numpy dtype", Function::dtype},
    {"numpy.core.multiarray scalar", Function::scalar},
    {"numpy._core.multiarray scalar", Function::scalar},
    {"_codecs encode", Function::encode},
    {"builtins range", Function::range},
    {"__builtin__ xrange", Function::range},
}};

template <class T>
int64_t load_integer(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<int64_t>(value);
}

std::optional<int64_t> whole(double value) {
  constexpr double kLimit = 9007199254740992.0;  // 2^53: beyond it not every whole number is real
  if (!(std::abs(value) <= kLimit) || value != std::floor(value)) return std::nullopt;
  return static_cast<int64_t>(value);
}

// A number of NumPy type `type` ("i8") at the beginning of `bytes`.
std::optional<int64_t> load_number(std::string_view type, const char* bytes) {
  if (type == "i8") return load_integer<int64_t>(bytes);
  if (type == "i4") return load_integer<int32_t>(bytes);
  if (type == "i2") return load_integer<int16_t>(bytes);
  if (type == "i1") return load_integer<int8_t>(bytes);
  if (type == "u4") return load_integer<uint32_t>(bytes);
  if (type == "u2") return load_integer<uint16_t>(bytes);
  if (type == "u1" || type == "b1") return load_integer<uint8_t>(bytes);
  if (type == "u8") {
    const int64_t value = load_integer<uint64_t>(bytes);
    return value < 0 ? std::nullopt : std::optional(value);
  }
  if (type == "f8") {
    double value = 0;
    std::memcpy(&value, bytes, sizeof(value));
    return whole(value);
  }
  return std::nullopt;
}

// Bytes of a number of that type; 0 for a type that isn't one of load_number's.
size_t number_size(std::string_view type) {
  constexpr std::string_view kTypes = "i8 i4 i2 i1 u8 u4 u2 u1 b1 f8";
  if (type.size() != 2 || kTypes.find(type) == std::string_view::npos) return 0;
  return static_cast<size_t>(type[1] - '0');
}

}  // namespace

/// Runs the instructions; of the file, only what it builds remains.
class PickleMachine {
 public:
  PickleMachine(Pickle& pickle, std::string_view bytes, FileLocation location)
      : pickle_(pickle), bytes_(bytes), location_(std::move(location)) {}

  PickleValue run() {
    if (bytes_.size() > kMaxBytes) fail("it is too large");
    for (;;) {
      const auto code = static_cast<uint8_t>(take(1).front());
      if (code == '.') break;
      step(code);
    }
    if (at_ != bytes_.size()) fail("bytes follow its end");
    if (stack_.size() != 1 || !marks_.empty()) fail("it leaves more than one value");
    return stack_.front();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    location_.fail(
        fmt::format("is no NumPy array of objects that may be read safely: {} (byte {} "
                    "of its pickle)",
                    what, at_));
  }

  std::string_view take(size_t count) {
    if (count > bytes_.size() - at_) fail("it ends early");
    const std::string_view taken = bytes_.substr(at_, count);
    at_ += count;
    return taken;
  }

  uint64_t take_number(size_t size) {
    uint64_t value = 0;
    const std::string_view raw = take(size);
    for (size_t i = 0; i < size; ++i) value |= uint64_t{static_cast<uint8_t>(raw[i])} << (8 * i);
    return value;
  }

  std::string_view take_line() {
    const size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) fail("it ends early");
    const std::string_view line = take(end - at_);
    take(1);
    return line;
  }

  void push(PickleValue value) { stack_.push_back(value); }
  void push_integer(int64_t number) {
    PickleValue value;
    value.kind = PickleKind::integer;
    value.integer = number;
    push(value);
  }
  PickleValue make(PickleKind kind, PickleObject object) {
    PickleValue value;
    value.kind = kind;
    value.index = pickle_.objects_.size();
    pickle_.objects_.push_back(std::move(object));
    return value;
  }
  void push_text(std::string_view text) {
    PickleObject object;
    object.text = text;
    push(make(PickleKind::text, std::move(object)));
  }

  PickleValue pop() {
    if (stack_.size() <= floor()) fail("it takes more than there is");
    const PickleValue value = stack_.back();
    stack_.pop_back();
    return value;
  }
  size_t floor() const { return marks_.empty() ? 0 : marks_.back(); }

  std::vector<PickleValue> pop_to_mark() {
    if (marks_.empty()) fail("a mark is missing");
    const auto first = stack_.begin() + static_cast<ptrdiff_t>(marks_.back());
    std::vector<PickleValue> items(first, stack_.end());
    stack_.erase(first, stack_.end());
    marks_.pop_back();
    return items;
  }

  void push_list(std::vector<PickleValue> items) {
    PickleObject object;
    object.items = std::move(items);
    push(make(PickleKind::list, std::move(object)));
  }
  void push_tuple(size_t count) {
    std::vector<PickleValue> items(count);
    for (size_t i = count; i-- > 0;) items[i] = pop();
    push_list(std::move(items));
  }

  PickleObject& object(const PickleValue& value, PickleKind kind) {
    if (value.kind != kind) fail("a value is of another kind than expected");
    return pickle_.objects_[value.index];
  }
  std::vector<PickleValue> short_list(const PickleValue& value) {
    const auto& items = object(value, PickleKind::list).items;
    if (items.size() > kMostArguments) fail("a list of arguments is too long");
    return items;
  }
  int64_t integer(const PickleValue& value) const {
    if (value.kind != PickleKind::integer) fail("a number is missing");
    return value.integer;
  }

  void append(const std::vector<PickleValue>& items) {
    if (stack_.size() <= floor()) fail("a list is missing");
    auto& list = object(stack_.back(), PickleKind::list).items;
    list.insert(list.end(), items.begin(), items.end());
  }

  void remember(uint64_t key) {
    if (stack_.size() <= floor()) fail("it keeps a value that is not there");
    memo_[key] = stack_.back();
  }
  void recall(uint64_t key) {
    const auto found = memo_.find(key);
    if (found == memo_.end()) fail("it recalls a value that was not kept");
    push(found->second);
  }

  void push_long(size_t size) {
    if (size > 8) fail("a number has more than 64 bits");
    uint64_t value = take_number(size);
    if (size > 0 && size < 8 && (value >> (8 * size - 1)) != 0) value |= ~uint64_t{0} << (8 * size);
    push_integer(static_cast<int64_t>(value));
  }

  void push_real() {  // big-endian
    uint64_t bits = 0;
    for (const char c : take(8)) bits = bits << 8 | static_cast<uint8_t>(c);
    PickleValue value;
    value.kind = PickleKind::real;
    value.real = std::bit_cast<double>(bits);
    push(value);
  }

  void push_global(std::string_view module, std::string_view name) {
    for (const Global& global : kGlobals) {
      const size_t space = global.name.find(' ');
      if (global.name.substr(0, space) != module || global.name.substr(space + 1) != name) continue;
      PickleObject object;
      object.text = global.name;
      push(make(PickleKind::global, std::move(object)));
      return;
    }
    fail(fmt::format("it wants to call {}.{}", module.substr(0, 60), name.substr(0, 60)));
  }

  Function function(const PickleValue& value) {
    const std::string_view name = object(value, PickleKind::global).text;
    for (const Global& global : kGlobals)
      if (global.name == name) return global.function;
    fail("a function is missing");
  }

  void push_encoded(const std::vector<PickleValue>& arguments) {
    if (arguments.empty() || arguments.size() > 2) fail("a text has no encoding");
    // UTF-8 to Latin-1: a code point up to 255 is a byte.
    std::string bytes;
    const std::string_view text = object(arguments[0], PickleKind::text).text;
    for (size_t i = 0; i < text.size(); ++i) {
      const auto c = static_cast<uint8_t>(text[i]);
      if (c < 0x80) {
        bytes += text[i];
      } else if ((c == 0xc2 || c == 0xc3) && i + 1 < text.size() &&
                 (static_cast<uint8_t>(text[i + 1]) & 0xc0) == 0x80) {
        bytes += static_cast<char>((c & 3) << 6 | (static_cast<uint8_t>(text[++i]) & 0x3f));
      } else {
        fail("a text is not Latin-1");
      }
    }
    encoded_bytes_ += bytes.size();
    if (encoded_bytes_ > bytes_.size()) fail("it encodes a text more than once");
    push_text(pickle_.texts_.emplace_back(std::move(bytes)));
  }

  void push_type(const std::vector<PickleValue>& arguments) {
    if (arguments.empty()) fail("a type has no name");
    PickleObject object;
    object.text = this->object(arguments[0], PickleKind::text).text;
    push(make(PickleKind::type, std::move(object)));
  }

  // numpy.core.multiarray.scalar(type, bytes): one number.
  void push_scalar(const std::vector<PickleValue>& arguments) {
    if (arguments.size() != 2) fail("a number has no type");
    const std::string_view type = object(arguments[0], PickleKind::type).text;
    const std::string_view bytes = object(arguments[1], PickleKind::text).text;
    if (number_size(type) == 0 || bytes.size() != number_size(type))
      fail("a number has an unknown type");
    const auto number = load_number(type, bytes.data());
    if (!number) fail("a number is not whole");
    push_integer(*number);
  }

  void reduce() {
    const std::vector<PickleValue> arguments = short_list(pop());
    const PickleValue callee = pop();
    switch (function(callee)) {
      case Function::reconstruct:
        if (arguments.empty() || function(arguments[0]) != Function::ndarray)
          fail("it rebuilds something else than an array");
        return push(make(PickleKind::array, {}));
      case Function::dtype:
        return push_type(arguments);
      case Function::scalar:
        return push_scalar(arguments);
      case Function::encode:
        return push_encoded(arguments);
      case Function::range: {
        if (arguments.size() != 3) fail("a range has no three numbers");
        for (const PickleValue& argument : arguments) integer(argument);
        PickleObject object;
        object.items = arguments;
        return push(make(PickleKind::range, std::move(object)));
      }
      case Function::ndarray:
        break;
    }
    fail("it calls a type");
  }

  // The state of a type is (version, byte order, ...), of an array (version, shape, type,
  // is Fortran-ordered, data).
  void build() {
    const std::vector<PickleValue> state = short_list(pop());
    if (stack_.size() <= floor()) fail("it builds nothing");
    const PickleValue target = stack_.back();
    if (target.kind == PickleKind::type) {
      if (state.size() < 2) fail("the state of a type is too short");
      if (object(state[1], PickleKind::text).text == ">") fail("its numbers are big-endian");
      return;
    }
    if (target.kind != PickleKind::array || state.size() != 5) fail("the state of an array is odd");
    PickleObject array;
    for (const PickleValue& extent : short_list(state[1])) {
      if (integer(extent) < 0) fail("an array has a negative extent");
      array.shape.push_back(static_cast<size_t>(extent.integer));
    }
    const std::string_view type = object(state[2], PickleKind::type).text;
    if (integer(state[3]) != 0) fail("an array is in Fortran order");
    array.type = type.starts_with('O') ? "O" : type;
    if (array.type == "O") {
      object(state[4], PickleKind::list);
      array.items = {state[4]};
    } else {
      array.text = object(state[4], PickleKind::text).text;
    }
    require_size(array);
    pickle_.objects_[target.index] = std::move(array);
  }

  void require_size(const PickleObject& array) const {
    size_t count = 1;
    bool overflow = false;
    for (const size_t extent : array.shape)
      overflow = __builtin_mul_overflow(count, extent, &count) || overflow;
    const size_t size = number_size(array.type);
    const bool fits = array.type == "O" ? count == pickle_.elements(array).size()
                                        : size > 0 && array.text.size() % size == 0 &&
                                              count == array.text.size() / size;
    if (overflow || !fits) fail("the shape of an array does not fit its data");
  }

  void step(uint8_t code) {
    switch (code) {
      case 0x80:  // PROTO
        if (take_number(1) > 5) fail("it is of an unknown version");
        return;
      case 0x95:  // FRAME
        take(8);
        return;
      case '(':
        return marks_.push_back(stack_.size());
      case 'N':
        return push({});
      case 0x88:
      case 0x89:
        return push_integer(code == 0x88 ? 1 : 0);
      case 'K':
        return push_integer(static_cast<int64_t>(take_number(1)));
      case 'M':
        return push_integer(static_cast<int64_t>(take_number(2)));
      case 'J':
        return push_integer(static_cast<int32_t>(take_number(4)));
      case 0x8a:  // LONG1
        return push_long(take_number(1));
      case 'G':
        return push_real();
      case 'q':
        return remember(take_number(1));
      case 'r':
        return remember(take_number(4));
      case 0x94:  // MEMOIZE
        return remember(memo_.size());
      case 'h':
        return recall(take_number(1));
      case 'j':
        return recall(take_number(4));
      default:
        return step_compound(code);
    }
  }

  void step_compound(uint8_t code) {
    switch (code) {
      case ']':
      case ')':
        return push_list({});
      case 'a': {
        const PickleValue item = pop();
        return append({item});
      }
      case 'e': {
        const std::vector<PickleValue> items = pop_to_mark();
        return append(items);
      }
      case 't':
        return push_list(pop_to_mark());
      case 0x85:
      case 0x86:
      case 0x87:
        return push_tuple(code - size_t{0x84});
      case 'U':
      case 'C':
      case 0x8c:  // short strings: Python 2, bytes, text
        return push_text(take(take_number(1)));
      case 'T':
      case 'B':
      case 'X':
        return push_text(take(take_number(4)));
      case 'c': {
        const std::string_view module = take_line();
        return push_global(module, take_line());
      }
      case 0x93: {  // STACK_GLOBAL
        const PickleValue name = pop();
        const PickleValue module = pop();
        return push_global(object(module, PickleKind::text).text,
                           object(name, PickleKind::text).text);
      }
      case 'R':
        return reduce();
      case 'b':
        return build();
      default:
        fail(fmt::format("the instruction {:#04x} is not allowed", code));
    }
  }

  Pickle& pickle_;
  std::string_view bytes_;
  FileLocation location_;
  size_t at_ = 0;
  std::vector<PickleValue> stack_;
  std::vector<size_t> marks_;
  std::unordered_map<uint64_t, PickleValue> memo_;
  size_t encoded_bytes_ = 0;
};

Pickle::Pickle(std::string_view bytes, const FileLocation& location) {
  root_ = PickleMachine(*this, bytes, location).run();
}

std::optional<uint64_t> Pickle::length(const PickleValue& value) const {
  switch (value.kind) {
    case PickleKind::list:
      return object(value).items.size();
    case PickleKind::array:
      return object(value).shape.size() == 1 ? std::optional<uint64_t>(object(value).shape[0])
                                             : std::nullopt;
    case PickleKind::range: {
      const auto& items = object(value).items;
      const int64_t step = items[2].integer;
      int64_t distance = 0;
      if (step <= 0 || __builtin_sub_overflow(items[1].integer, items[0].integer, &distance))
        return std::nullopt;
      const auto unsigned_step = static_cast<uint64_t>(step);
      return distance <= 0 ? 0 : (static_cast<uint64_t>(distance) - 1) / unsigned_step + 1;
    }
    default:
      return std::nullopt;
  }
}

std::optional<int64_t> Pickle::whole_number(const PickleValue& value) {
  if (value.kind == PickleKind::integer) return value.integer;
  if (value.kind == PickleKind::real) return whole(value.real);
  return std::nullopt;
}

std::optional<int64_t> Pickle::whole_number(const PickleValue& value, uint64_t i) const {
  const PickleObject& sequence = object(value);
  if (value.kind == PickleKind::range)
    return sequence.items[0].integer + static_cast<int64_t>(i) * sequence.items[2].integer;
  if (value.kind == PickleKind::array && sequence.type != "O")
    return load_number(sequence.type, sequence.text.data() + i * number_size(sequence.type));
  return whole_number(value.kind == PickleKind::array ? elements(sequence)[i] : sequence.items[i]);
}

}  // namespace vpr
