// Descriptors of other programs, read from .npy files.
#include "database/imported.h"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "database/frame_descriptors.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

DescriptorSet import(const SequenceArgument& argument, std::string_view kind = kNarrowVectorKind,
                     Unreadable unreadable = Unreadable::fail) {
  return import_descriptors(open_sequence(argument), kind, unreadable, {});
}

std::vector<int> numbers(const DescriptorRow& row) {
  std::vector<int> values;
  for (const uint8_t byte : row) values.push_back(static_cast<int8_t>(byte));
  return values;
}

std::vector<float> random_numbers(size_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<float> values;
  for (size_t i = 0; i < count; ++i)
    values.push_back(static_cast<float>(uniform_below(engine, 20'001)) / 10'000 - 1);
  return values;
}

std::string refusal(const SequenceArgument& argument, std::string_view kind = kNarrowVectorKind,
                    Unreadable unreadable = Unreadable::fail) {
  CHECK(error_kind([&] { import(argument, kind, unreadable); }) == ErrorKind::data);
  return error_text([&] { import(argument, kind, unreadable); });
}

}  // namespace

TEST_CASE("vectors become integers up to 127, with ties rounded to even") {
  const std::string path = "v.npy";
  write_array<float>(path, {2, -1, 0.5F, 0, -8, 4, 2, 1, 254, 1, 3, -5}, {3, 4});
  const DescriptorSet set = import({path, {}});
  CHECK(set.descriptors.kind->name == "vectors8");
  CHECK(set.rows().shape == DescriptorShape{ElementType::int8, 4});
  REQUIRE(set.rows().size() == 3);
  CHECK(numbers(set.rows()[0]) == std::vector<int>{127, -64, 32, 0});  // 63.5 -> 64, 31.75
  CHECK(numbers(set.rows()[1]) == std::vector<int>{-127, 64, 32, 16});
  CHECK(numbers(set.rows()[2]) == std::vector<int>{127, 0, 2, -2});  // 0.5, 1.5, 2.5
  CHECK(set.sequence.frame_names == std::vector<std::string>{"#0", "#1", "#2"});
  CHECK(set.sequence.unreadable.empty());
}

TEST_CASE("16-bit vectors are as long as scalar products in 32 bits allow") {
  std::vector<int16_t> out(2);
  quantize_numbers(std::vector<double>{3, 0}, std::span(out));
  CHECK(out == std::vector<int16_t>{32767, 0});  // one value uses all 16 bits
  quantize_numbers(std::vector<double>{-1e-300, 1e-300}, std::span(out));
  CHECK(out == std::vector<int16_t>{-32767, 32767});  // (46340 - 0.7) / sqrt(2) = 32766.8
  for (const size_t length : {1, 5, 300, 4096, 131'071}) {
    std::vector<double> vector(length, 1);  // equal values: all are rounded in the same direction
    vector[0] = 1.5;
    std::vector<int16_t> wide(length);
    quantize_numbers(vector, std::span(wide));
    int64_t square = 0;
    for (const int16_t number : wide) square += int64_t{number} * number;
    CHECK(square <= kMaxSquaredLength);
    CHECK((length < 5 || square > int64_t{45900} * 45900));
  }
}

TEST_CASE("quantized directions are within the documented error") {
  for (const size_t length : {16, 512, 4096}) {
    const std::vector<float> values = random_numbers(length, length);
    const std::vector<double> vector(values.begin(), values.end());
    std::vector<int8_t> narrow(length);
    std::vector<int16_t> wide(length);
    quantize_numbers(vector, std::span(narrow));
    quantize_numbers(vector, std::span(wide));
    const auto cosine = [&](const auto& numbers) {
      double product = 0;
      double own = 0;
      double other = 0;
      for (size_t i = 0; i < length; ++i) {
        const auto number = static_cast<double>(numbers[i]);
        product += vector[i] * number;
        own += vector[i] * vector[i];
        other += number * number;
      }
      return product / std::sqrt(own) / std::sqrt(other);
    };
    CHECK(1 - cosine(narrow) < 3e-5);  // angle^2 / 2
    CHECK(1 - cosine(wide) < 1e-7);
  }
}

TEST_CASE("arrays of any type, order, range or folder yield the same rows") {
  const std::vector<float> values = random_numbers(700 * 30, 1);
  const std::vector<double> doubles(values.begin(), values.end());
  write_array("c.npy", values, {700, 30});
  write_array("f.npy", values, {700, 30}, true);
  write_array("d.npy", doubles, {700, 30});
  write_array("df.npy", doubles, {700, 30}, true);
  const DescriptorSet all = import({"c.npy", {}});
  for (const char* name : {"f.npy", "d.npy", "df.npy"}) {
    INFO(name);
    CHECK(import({name, {}}).descriptors.owned == all.descriptors.owned);
    for (const std::string_view kind : {kNarrowVectorKind, kVectorKind}) {
      const DescriptorSet part = import({name, {5, 699, 3}}, kind);
      const DescriptorSet whole = import({"c.npy", {}}, kind);
      REQUIRE(part.rows().size() == 232);
      for (size_t i = 0; i < part.rows().size(); ++i)
        REQUIRE(std::ranges::equal(part.rows()[i], whole.rows()[5 + 3 * i]));
      CHECK(part.sequence.frame_names[2] == "#11");
    }
  }
  std::filesystem::create_directory("each");
  for (size_t i = 0; i < 12; ++i)
    write_array("each/" + std::to_string(i) + ".npy",
                std::vector<float>(values.begin() + ptrdiff_t(30 * i),
                                   values.begin() + ptrdiff_t(30 * i + 30)),
                i % 2 == 0 ? std::vector<size_t>{30} : std::vector<size_t>{1, 30});
  const DescriptorSet each = import({"each", {2, std::nullopt, 1}});  // 2, 3, ... 10, 11
  CHECK(each.sequence.frame_names.front() == "2.npy");
  CHECK(each.sequence.frame_names.back() == "11.npy");
  CHECK(std::ranges::equal(each.rows().bytes, all.rows().subspan(2, 10).bytes));
  write_text("list.txt", "each/3.npy\neach/1.npy\n");
  CHECK(std::ranges::equal(import({"list.txt", {}}).rows()[1], all.rows()[1]));
}

TEST_CASE("half-precision floats are read") {
  write_text("h.npy", npy_header("<f2", {1, 3}) + std::string("\x00\x3c\x00\xb8\x01\x00", 6));
  const ArrayRows rows(open_sequence({"h.npy", {}}));
  std::vector<double> numbers(3);
  rows.read(0, 1, numbers);
  CHECK(numbers == std::vector<double>{1, -0.5, std::ldexp(1.0, -24)});
}

TEST_CASE("bits of any number type are read") {
  write_array<uint8_t>("b.npy", {1, 255, 0, 7, 8, 9}, {2, 3});
  const DescriptorSet bytes = import({"b.npy", {}}, kBitKind);
  CHECK(bytes.rows().shape == DescriptorShape{ElementType::bits, 24});
  CHECK(std::ranges::equal(bytes.rows()[1], std::vector<uint8_t>{7, 8, 9, 0, 0, 0, 0, 0}));
  const std::string header = npy_header("|b1", {2, 9});
  write_text("t.npy", header + std::string("\1\0\0\0\0\0\0\1\1\0\1\0\0\0\0\0\0\0", 18));
  const DescriptorSet bits = import({"t.npy", {}}, kBitKind);
  CHECK(bits.rows().shape == DescriptorShape{ElementType::bits, 9});
  CHECK(std::ranges::equal(bits.rows()[0], std::vector<uint8_t>{0x81, 1, 0, 0, 0, 0, 0, 0}));
  CHECK(std::ranges::equal(bits.rows()[1], std::vector<uint8_t>{2, 0, 0, 0, 0, 0, 0, 0}));
}

TEST_CASE("invalid descriptors are refused with the row") {
  const std::string path = "v.npy";
  const std::string& name = path;
  std::vector<double> values(40 * 3, 1);
  values[3 * 17] = 0;
  write_array(path, values, {40, 3});
  CHECK_NOTHROW(import({path, {}}));
  values[3 * 17 + 1] = values[3 * 17 + 2] = 0;
  write_array(path, values, {40, 3});
  CHECK(
      refusal({path, {}}) ==
      name +
          ": row 17 is a vector of zeros, which has no direction; use --skip-unreadable to ignore "
          "it");
  CHECK(refusal({path, {10, 30, 1}}).starts_with(name + ": row 17 is"));
  CHECK(import({path, {}}, kVectorKind, Unreadable::skip).sequence.unreadable ==
        std::vector<size_t>{17});
  values[3 * 9 + 2] = std::numeric_limits<double>::infinity();
  write_array(path, values, {40, 3}, true);
  CHECK(refusal({path, {}}) == name + ": row 9: value 2 is inf");
  values[3 * 5 + 1] = kNan;
  write_array(path, values, {40, 3});
  CHECK(refusal({path, {}}, kVectorKind, Unreadable::skip) == name + ": row 5: value 1 is nan");
  CHECK(has(refusal({path, {}}, kBitKind), "bits are uint8"));
  write_array<uint8_t>(path, {1, 2}, {1, 2});
  CHECK(has(refusal({path, {}}), "as float32; if they are bits, train with --bits"));
  write_array<int32_t>(path, {1, 2}, {1, 2});
  CHECK(has(refusal({path, {}}), "type <i4"));
  write_array<double>(path, {1, 2}, {2});
  CHECK(refusal({path, {}}) ==
        name + ": expected n x d values, one row per frame, found the shape (2)");
  write_array<double>(path, {}, {0, 4});
  CHECK(has(refusal({path, {}}), "shape (0, 4)"));
  write_array<double>(path, {}, {4, 0});
  CHECK(has(refusal({path, {}}), "shape (4, 0)"));
  write_array(path, std::vector<uint8_t>(8185, 1), {1, 8185});
  CHECK(has(refusal({path, {}}, kBitKind), "maximum is 8184"));
  write_array(path, std::vector<float>(131'072, 1), {1, 131'072});
  CHECK(has(refusal({path, {}}), "maximum is 131071"));
  write_array<double>(path, {1, 2}, {2, 1});
  CHECK(error_kind([&] { import({path, { 2, std::nullopt, 1 }}); }) == ErrorKind::usage);
  CHECK(error_kind([&] { import({path, { 0, 3, 1 }}); }) == ErrorKind::usage);
}

TEST_CASE("files of a folder must have the same type and length") {
  write_array<float>("0.npy", {1, 2, 3}, {3});
  write_array<float>("1.npy", {1, 2}, {2});
  CHECK(refusal({".", {}}).starts_with(std::string("./1.npy") + ": holds 2 values"));
  write_array<double>("1.npy", {1, 2, 3}, {3});
  CHECK(refusal({".", {}}).starts_with(std::string("./1.npy")));
  write_array<float>("1.npy", {1, 2, 3, 4, 5, 6}, {2, 3});
  CHECK(has(refusal({".", {}}), "expected one descriptor"));
}

TEST_CASE("a missing row keeps its index, unless all rows are missing") {
  const std::string path = "v.npy";
  write_array<double>(path, {1, 2, kNan, kNan, 3, 4}, {3, 2});
  CHECK(refusal({path, {}}) ==
        path + ": row 1 is missing (all NaN); use --skip-unreadable to ignore it");
  const DescriptorSet set = import({path, {}}, kNarrowVectorKind, Unreadable::skip);
  CHECK(set.sequence.unreadable == std::vector<size_t>{1});
  CHECK(set.rows().size() == 3);
  CHECK(numbers(set.rows()[1]) == std::vector<int>{0, 0});
  write_array<double>(path, {kNan, kNan}, {1, 2});
  CHECK(has(refusal({path, {}}, kNarrowVectorKind, Unreadable::skip), "none of its"));
}

TEST_CASE("the smallest and the largest numbers have directions, and distant points are refused") {
  for (const double size : {5e-324, 1e-310, 1.0, 1e300, 1.7e308}) {
    INFO(size);
    write_array("db.npy", std::vector<double>{size, 0, -size, size}, {2, 2});
    const SequenceSource sequence = open_sequence({"db.npy", {}});
    const double unit = coordinate_unit(kDirectionKind, {&sequence, 1}, {});
    const DescriptorSet set =
        import_descriptors(sequence, kDirectionKind, Unreadable::fail, {}, unit);
    std::vector<int16_t> numbers(4);
    std::memcpy(numbers.data(), set.rows().bytes.data(), set.rows().bytes.size());
    CHECK(numbers == std::vector<int16_t>{32766, 0, -23169, 23169});
    if (size > 1e307) {
      CHECK(error_text([&] {
              coordinate_unit(kPointKind, {&sequence, 1}, {});
            }) == std::string("db.npy") + ": row 0: is too long for Euclidean distances");
    } else {
      const double of_points = coordinate_unit(kPointKind, {&sequence, 1}, {});
      import_descriptors(sequence, kPointKind, Unreadable::fail, {}, of_points);
    }
  }
}
