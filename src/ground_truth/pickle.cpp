#include "ground_truth/pickle.h"

#include <array>
#include <bit>

#include <fmt/format.h>

#include "base/printable.h"
#include "ground_truth/numpy_number.h"
#include "ground_truth/pickle_input.h"

namespace vpr {
namespace {

// A byte of the file may become a hundred in memory.
constexpr size_t kMaxBytes = size_t{1} << 26;
constexpr size_t kMostObjects = size_t{1} << 22;
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

// Of a name that may be long.
std::string start_of(std::string_view name) { return printable_line(name.substr(0, 60)); }

}  // namespace

/// Runs the instructions; of the file, only what it builds remains.
class PickleMachine {
 public:
  PickleMachine(Pickle& pickle, std::string_view bytes, FileLocation location)
      : pickle_(pickle), input_(bytes, std::move(location)) {}

  PickleValue run() {
    if (input_.size() > kMaxBytes) input_.fail("it is too large");
    for (;;) {
      const auto code = static_cast<uint8_t>(input_.take(1).front());
      if (code == '.') break;
      step(code);
    }
    if (!input_.at_end()) input_.fail("bytes follow its end");
    return stack_.only();
  }

 private:
  PickleValue make(PickleKind kind, PickleObject object) {
    if (pickle_.objects_.size() == kMostObjects) input_.fail("it holds too many lists");
    PickleValue value;
    value.kind = kind;
    value.index = pickle_.objects_.size();
    pickle_.objects_.push_back(std::move(object));
    return value;
  }
  void push_text(std::string_view text) {
    PickleObject object;
    object.text = text;
    stack_.push(make(PickleKind::text, std::move(object)));
  }

  void push_list(std::vector<PickleValue> items) {
    PickleObject object;
    object.items = std::move(items);
    stack_.push(make(PickleKind::list, std::move(object)));
  }
  void push_tuple(size_t count) {
    std::vector<PickleValue> items(count);
    for (size_t i = count; i-- > 0;) items[i] = stack_.pop();
    push_list(std::move(items));
  }

  PickleObject& object(const PickleValue& value, PickleKind kind) {
    if (value.kind != kind) input_.fail("a value is of another kind than expected");
    return pickle_.objects_[value.index];
  }
  std::vector<PickleValue> short_list(const PickleValue& value) {
    const auto& items = object(value, PickleKind::list).items;
    if (items.size() > kMostArguments) input_.fail("a list of arguments is too long");
    return items;
  }
  int64_t integer(const PickleValue& value) const {
    if (value.kind != PickleKind::integer) input_.fail("a number is missing");
    return value.integer;
  }

  void append(const std::vector<PickleValue>& items) {
    auto& list = object(stack_.top(), PickleKind::list).items;
    list.insert(list.end(), items.begin(), items.end());
  }

  void push_long(size_t size) {
    if (size > 8) input_.fail("a number has more than 64 bits");
    uint64_t value = input_.take_number(size);
    if (size > 0 && size < 8 && (value >> (8 * size - 1)) != 0) value |= ~uint64_t{0} << (8 * size);
    stack_.push_integer(static_cast<int64_t>(value));
  }

  void push_real() {  // big-endian
    uint64_t bits = 0;
    for (const char c : input_.take(8)) bits = bits << 8 | static_cast<uint8_t>(c);
    stack_.push_real(std::bit_cast<double>(bits));
  }

  void push_global(std::string_view module, std::string_view name) {
    for (const Global& global : kGlobals) {
      const size_t space = global.name.find(' ');
      if (global.name.substr(0, space) != module || global.name.substr(space + 1) != name) continue;
      PickleObject object;
      object.text = global.name;
      stack_.push(make(PickleKind::global, std::move(object)));
      return;
    }
    input_.fail(fmt::format("it wants to call {}.{}", start_of(module), start_of(name)));
  }

  Function function(const PickleValue& value) {
    const std::string_view name = object(value, PickleKind::global).text;
    for (const Global& global : kGlobals)
      if (global.name == name) return global.function;
    input_.fail("a function is missing");
  }

  void push_encoded(const std::vector<PickleValue>& arguments) {
    if (arguments.empty() || arguments.size() > 2) input_.fail("a text has no encoding");
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
        input_.fail("a text is not Latin-1");
      }
    }
    encoded_bytes_ += bytes.size();
    if (encoded_bytes_ > input_.size()) input_.fail("it encodes a text more than once");
    push_text(pickle_.texts_.emplace_back(std::move(bytes)));
  }

  void push_type(const std::vector<PickleValue>& arguments) {
    if (arguments.empty()) input_.fail("a type has no name");
    PickleObject object;
    object.text = this->object(arguments[0], PickleKind::text).text;
    stack_.push(make(PickleKind::type, std::move(object)));
  }

  // numpy.core.multiarray.scalar(type, bytes): one number.
  void push_scalar(const std::vector<PickleValue>& arguments) {
    if (arguments.size() != 2) input_.fail("a number has no type");
    const std::string_view type = object(arguments[0], PickleKind::type).text;
    const std::string_view bytes = object(arguments[1], PickleKind::text).text;
    if (numpy_number_size(type) == 0 || bytes.size() != numpy_number_size(type))
      input_.fail("a number has an unknown type");
    const auto number = load_numpy_number(type, bytes.data());
    if (!number) input_.fail("a number is not whole");
    stack_.push_integer(*number);
  }

  void reduce() {
    const std::vector<PickleValue> arguments = short_list(stack_.pop());
    const PickleValue callee = stack_.pop();
    switch (function(callee)) {
      case Function::reconstruct:
        if (arguments.empty() || function(arguments[0]) != Function::ndarray)
          input_.fail("it rebuilds something else than an array");
        return stack_.push(make(PickleKind::array, {}));
      case Function::dtype:
        return push_type(arguments);
      case Function::scalar:
        return push_scalar(arguments);
      case Function::encode:
        return push_encoded(arguments);
      case Function::range: {
        if (arguments.size() != 3) input_.fail("a range has no three numbers");
        for (const PickleValue& argument : arguments) integer(argument);
        PickleObject object;
        object.items = arguments;
        return stack_.push(make(PickleKind::range, std::move(object)));
      }
      case Function::ndarray:
        break;
    }
    input_.fail("it calls a type");
  }

  // The state of a type is (version, byte order, ...), of an array (version, shape, type,
  // is Fortran-ordered, data).
  void build() {
    const std::vector<PickleValue> state = short_list(stack_.pop());
    const PickleValue target = stack_.top();
    if (target.kind == PickleKind::type) {
      if (state.size() < 2) input_.fail("the state of a type is too short");
      if (object(state[1], PickleKind::text).text == ">") input_.fail("its numbers are big-endian");
      return;
    }
    if (target.kind != PickleKind::array || state.size() != 5)
      input_.fail("the state of an array is odd");
    PickleObject array;
    for (const PickleValue& extent : short_list(state[1])) {
      if (integer(extent) < 0) input_.fail("an array has a negative extent");
      array.shape.push_back(static_cast<size_t>(extent.integer));
    }
    const std::string_view type = object(state[2], PickleKind::type).text;
    if (integer(state[3]) != 0) input_.fail("an array is in Fortran order");
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
    const size_t size = numpy_number_size(array.type);
    const bool fits = array.type == "O" ? count == pickle_.elements(array).size()
                                        : size > 0 && array.text.size() % size == 0 &&
                                              count == array.text.size() / size;
    if (overflow || !fits) input_.fail("the shape of an array does not fit its data");
  }

  void step(uint8_t code) {
    switch (code) {
      case 0x80:  // PROTO
        if (input_.take_number(1) > 5) input_.fail("it is of an unknown version");
        return;
      case 0x95:  // FRAME
        input_.take(8);
        return;
      case '(':
        return stack_.push_mark();
      case 'N':
        return stack_.push({});
      case 0x88:
      case 0x89:
        return stack_.push_integer(code == 0x88 ? 1 : 0);
      case 'K':
        return stack_.push_integer(static_cast<int64_t>(input_.take_number(1)));
      case 'M':
        return stack_.push_integer(static_cast<int64_t>(input_.take_number(2)));
      case 'J':
        return stack_.push_integer(static_cast<int32_t>(input_.take_number(4)));
      case 0x8a:  // LONG1
        return push_long(input_.take_number(1));
      case 'G':
        return push_real();
      case 'q':
        return stack_.remember(input_.take_number(1));
      case 'r':
        return stack_.remember(input_.take_number(4));
      case 0x94:  // MEMOIZE
        return stack_.remember_next();
      case 'h':
        return stack_.recall(input_.take_number(1));
      case 'j':
        return stack_.recall(input_.take_number(4));
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
        const PickleValue item = stack_.pop();
        return append({item});
      }
      case 'e': {
        const std::vector<PickleValue> items = stack_.pop_to_mark();
        return append(items);
      }
      case 't':
        return push_list(stack_.pop_to_mark());
      case 0x85:
      case 0x86:
      case 0x87:
        return push_tuple(code - size_t{0x84});
      case 'U':
      case 'C':
      case 0x8c:  // short strings: Python 2, bytes, text
        return push_text(input_.take(input_.take_number(1)));
      case 'T':
      case 'B':
      case 'X':
        return push_text(input_.take(input_.take_number(4)));
      case 'c': {
        const std::string_view module = input_.take_line();
        return push_global(module, input_.take_line());
      }
      case 0x93: {  // STACK_GLOBAL
        const PickleValue name = stack_.pop();
        const PickleValue module = stack_.pop();
        return push_global(object(module, PickleKind::text).text,
                           object(name, PickleKind::text).text);
      }
      case 'R':
        return reduce();
      case 'b':
        return build();
      default:
        input_.fail(fmt::format("the instruction {:#04x} is not allowed", code));
    }
  }

  Pickle& pickle_;
  PickleInput input_;
  PickleStack stack_{input_};
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
  if (value.kind == PickleKind::real) return whole_number_of(value.real);
  return std::nullopt;
}

std::optional<int64_t> Pickle::whole_number(const PickleValue& value, uint64_t i) const {
  const PickleObject& sequence = object(value);
  if (value.kind == PickleKind::range)
    return sequence.items[0].integer + static_cast<int64_t>(i) * sequence.items[2].integer;
  if (value.kind == PickleKind::array && sequence.type != "O")
    return load_numpy_number(sequence.type,
                             sequence.text.data() + i * numpy_number_size(sequence.type));
  return whole_number(value.kind == PickleKind::array ? elements(sequence)[i] : sequence.items[i]);
}

}  // namespace vpr
