// Runs a target without libFuzzer: every input in the given folders, once; or mutants of them.
//   fuzz_NAME [--mutants FIRST:END] FOLDER...
// Mutants have other values in their JSON and arrays. Targets add the checksums that make them
// valid, so that readers reach the values. A mutant is a function of the inputs and its number.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/text.h"
#include "fuzz.h"

using namespace vpr;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

/// Small random numbers.
struct Dice {
  std::mt19937_64 engine;
  size_t below(size_t count) { return count == 0 ? 0 : engine() % count; }
};

void add_values(Json& value, std::vector<Json*>& values) {
  values.push_back(&value);
  if (value.is_structured())
    for (auto& item : value) add_values(item, values);
}

Json other_number(const Json& number, Dice& dice) {
  const std::vector<Json> others = {
      0,          1,       -1,      2,    0.5,    INT32_MAX, int64_t{1} << 31, int64_t{1} << 32,
      UINT32_MAX, 1 << 20, 1 << 16, 1e15, 1e308,  -1e308,    INT64_MAX,        INT64_MIN,
      UINT64_MAX, 1e-300,  255,     -2,   -1e-300};
  if (number.is_number_integer() && dice.below(2) == 0)
    return number.get<int64_t>() / 2 + static_cast<int64_t>(dice.below(5)) - 2;
  return others[dice.below(others.size())];
}

void change(Json& json, Dice& dice) {
  std::vector<Json*> values;
  add_values(json, values);
  Json& value = *values[dice.below(values.size())];
  const Json other = *values[dice.below(values.size())];  // a copy: it may contain the value
  if (dice.below(6) == 0) {
    value = dice.below(4) == 0 ? Json() : other;
  } else if (value.is_number()) {
    value = other_number(value, dice);
  } else if (value.is_boolean()) {
    value = !value.get<bool>();
  } else if (value.is_string()) {
    const std::vector<std::string> texts = {"", "x", "../x", "1e9", std::string(5000, 'a')};
    value = dice.below(2) == 0 && other.is_string() ? other : Json(texts[dice.below(5)]);
  } else if (value.is_array()) {
    const size_t at = dice.below(value.size());
    const size_t kind = dice.below(4);
    if (kind == 0 || value.empty())
      value.push_back(other);
    else if (kind == 1)
      value.erase(at);
    else if (kind == 2)
      value.push_back(Json(value[at]));
    else
      std::swap(value[at], value[dice.below(value.size())]);
  } else if (value.is_object() && !value.empty()) {
    auto item = value.begin();
    std::advance(item, static_cast<std::ptrdiff_t>(dice.below(value.size())));
    const std::string key = item.key();
    dice.below(2) == 0 ? (void)value.erase(key) : (void)(value[key] = other);
  }
}

// Numbers of a text or a header become others, as do bytes of the rest.
void change(std::string& bytes, Dice& dice) {
  if (bytes.empty()) return;
  const size_t at = bytes.find_first_of("0123456789", dice.below(bytes.size()));
  const size_t kind = dice.below(4);
  if (kind < 2 && at != std::string::npos && (at < 200 || !bytes.starts_with("\x93NUMPY"))) {
    const std::vector<std::string> numbers = {"0", "1", "9", "-1", "99999", "4294967296", "1e999"};
    const size_t end = bytes.find_first_not_of("0123456789", at);
    const std::string& number = numbers[dice.below(numbers.size())];
    bytes.replace(at, (end == std::string::npos ? bytes.size() : end) - at, number);
  } else if (kind == 2) {
    bytes.resize(dice.below(bytes.size() + 1));
  } else {
    constexpr std::string_view kBytes("\x00\x01\x7f\x80\xff,\n", 7);
    bytes[dice.below(bytes.size())] = kBytes[dice.below(kBytes.size())];
  }
}

void change_part(std::string& bytes, Dice& dice) {
  std::optional<Json> json = parse_json(bytes);
  for (size_t changes = 1 + dice.below(3); changes > 0; --changes)
    json ? change(*json, dice) : change(bytes, dice);
  if (json) bytes = json->dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string mutant(const std::vector<std::string>& inputs, uint64_t number) {
  Dice dice{std::mt19937_64(number)};
  std::string input = inputs[dice.below(inputs.size())];
  std::vector<fuzz::Part> parts = fuzz::split_parts(input);
  if (parts.empty()) {
    change_part(input, dice);
    return input;
  }
  change_part(parts[dice.below(parts.size())].bytes, dice);
  input.clear();
  for (const fuzz::Part& part : parts) input += "--- " + part.name + "\n" + part.bytes + "\n";
  return input;
}

void run(const std::string& name, const std::string& bytes) {
  std::fprintf(stderr, "%s\n", name.c_str());  // the last one is the finding
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  const bool has_mutants = argc > 3 && std::string_view(argv[1]) == "--mutants";
  std::set<std::filesystem::path> files;
  for (int i = has_mutants ? 3 : 1; i < argc; ++i)
    for (const auto& entry : std::filesystem::directory_iterator(argv[i]))
      files.insert(entry.path());
  std::vector<std::string> inputs;
  for (const auto& path : files) {
    std::ifstream file(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    if (!has_mutants) run(path.string(), inputs.back());
  }
  size_t first = 0;
  size_t end = 0;
  if (has_mutants && std::sscanf(argv[2], "%zu:%zu", &first, &end) != 2) return 1;
  for (size_t number = first; number < end && !inputs.empty(); ++number)
    run("mutant " + std::to_string(number), mutant(inputs, number));
  std::printf("%zu inputs\n", has_mutants ? end - first : inputs.size());
  return inputs.empty() ? 1 : 0;
}
