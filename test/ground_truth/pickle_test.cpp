// Pickles of VPR-Bench, and hostile ones: nothing is ever executed, and nothing crashes.
#include "ground_truth/pickle.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/npy.h"
#include "ground_truth/ground_truth.h"
#include "support.h"

using namespace vpr;
using namespace std::string_literals;
using namespace std::string_view_literals;

namespace {

const std::string kArray(
    "cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\0\x85U\1b\x87R"sv);
const std::string kObjectType(
    "cnumpy\ndtype\nU\2O8K\0K\1\x87R(K\3U\1|NNNJ\377\377\377\377J\377"
    "\377\377\377K?tb"sv);

// An array of `rows` x 2 objects whose list has the given instructions between its marks.
std::string table(char rows, std::string_view items) {
  return "\x80\2"s + kArray + "(K\1K"s + rows + "K\2\x86" + kObjectType + "\x89](" +
         std::string(items) + "etb.";
}

GroundTruth read(const std::string& pickle, size_t query_frames, size_t train_frames,
                 const std::vector<size_t>& shape) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "g.npy", npy_header("|O", shape) + pickle);
  return read_ground_truth({"", folder / "g.npy"}, {query_frames, {{"ref", train_frames}}});
}

std::string row(const GroundTruth& truth, size_t query, size_t frames) {
  std::string text;
  for (size_t r = 0; r < frames; ++r)
    text += truth.label(query, 0, r) == PlaceLabel::same ? 'S' : '.';
  return text;
}

}  // namespace

TEST_CASE("a row of a query and its references") {
  // [0, [1, 2]], [1, []]
  const GroundTruth truth = read(table(2, "K\0](K\1K\2eK\1]"sv), 2, 4, {2, 2});
  CHECK(row(truth, 0, 4) == ".SS.");
  CHECK(row(truth, 1, 4) == "....");
  CHECK_FALSE(truth.has_match(1));
}

TEST_CASE("references as tuple, range, real number, NumPy array and NumPy number") {
  const auto one = [](std::string_view references) {
    return row(read(table(1, "K\0"s + std::string(references)), 1, 5, {1, 2}), 0, 5);
  };
  CHECK(one("K\1K\3\x86"sv) == ".S.S.");                            // (1, 3)
  CHECK(one("cbuiltins\nrange\nK\0K\5K\2\x87R"sv) == "S.S.S");      // range(0, 5, 2)
  CHECK(one("c__builtin__\nxrange\nK\3K\1K\1\x87R"sv) == ".....");  // range(3, 1)
  CHECK(one("]G\x40\0\0\0\0\0\0\0a"sv) == "..S..");                 // [2.0]
  CHECK(one("]\x8a\2\4\0a"sv) == "....S");                          // [4] as a long
  CHECK(one("]cnumpy.core.multiarray\nscalar\ncnumpy\ndtype\nU\2i4K\0K\1\x87RC\4\3\0\0\0\x86"
            "Ra"sv) == "...S.");  // [int32(3)]
  CHECK(one(kArray + std::string("(K\1K\2\x85"
                                 "cnumpy\ndtype\nU\2u2K\0K\1\x87R\x89"
                                 "C\4\1\0\4\0tb"sv)) == ".S..S");  // array([1, 4])
  CHECK(one("(K\1t"sv) == ".S...");
}

TEST_CASE("one list or array of references for every query") {
  const std::string pickle = "\x80\2"s + kArray + std::string("(K\1K\2\x85"sv) + kObjectType +
                             std::string("\x89](](K\1e](K\0K\2eetb."sv);
  const GroundTruth truth = read(pickle, 2, 3, {2});
  CHECK(row(truth, 0, 3) == ".S.");
  CHECK(row(truth, 1, 3) == "S.S");
}

TEST_CASE("what is not such a table is damaged") {
  const auto kind = [](const std::string& pickle, const std::vector<size_t>& shape = {1, 2}) {
    return test::error_kind([&] { read(pickle, 1, 5, shape); });
  };
  CHECK_FALSE(kind(table(1, "K\0](K\1e"sv)).has_value());
  CHECK(kind(table(1, "K\0](K\5e"sv)) == ErrorKind::data);                   // reference 5 of 5
  CHECK(kind(table(1, "K\1](K\0e"sv)) == ErrorKind::data);                   // query 1 of 1
  CHECK(kind(table(1, "J\377\377\377\377]"sv)) == ErrorKind::data);          // query -1
  CHECK(kind(table(1, "K\0K\1"sv)) == ErrorKind::data);                      // no list
  CHECK(kind(table(1, "K\0](Ne"sv)) == ErrorKind::data);                     // None
  CHECK(kind(table(1, "K\0]G\x3f\xe0\0\0\0\0\0\0a"sv)) == ErrorKind::data);  // 0.5
  CHECK(kind(table(1, "K\0"sv)) == ErrorKind::data);                         // half a row
  CHECK(kind(table(2, "K\0]K\0]"sv), {2, 2}) == ErrorKind::data);  // rows for 2 queries of 1
  CHECK(kind(table(1, "K\0]"sv), {3, 2}) == ErrorKind::data);      // the header says otherwise
  CHECK(kind(table(1, "K\0cbuiltins\nrange\nK\0J\377\377\377\177K\1\x87R"sv)) ==
        ErrorKind::data);  // more than there are frames
  CHECK(kind(table(1, "K\0cbuiltins\nrange\nK\0K\1K\0\x87R"sv)) == ErrorKind::data);  // step 0
}

TEST_CASE("a pickle that would run something is refused, and nothing runs") {
  const test::TemporaryFolder folder;
  const std::string victim = folder / "victim";
  const std::string command = "touch " + victim;
  for (const std::string& pickle :
       {"cos\nsystem\n(X"s + static_cast<char>(command.size()) + "\0\0\0"s + command + "tR.",
        "cposix\nsystem\n(U"s + static_cast<char>(command.size()) + command + "tR.",
        "(S'" + command + "'\nios\nsystem\n.", "c__builtin__\neval\n(U\1"s + "1tR."s,
        "cbuiltins\nexec\n(U\1"s + "1tR."s, "cnumpy.core.multiarray\nfromfile\n(tR."s,
        "cnumpy\nload\n(tR."s, "\x80\4\x8c\2os\x8c\6system\x93\x8c\1x\x85R."s,
        "cnumpy.core\nmultiarray _reconstruct\n."s}) {
    CHECK(test::error_kind([&] { read(pickle, 1, 1, {1, 2}); }) == ErrorKind::data);
  }
  CHECK_FALSE(std::filesystem::exists(victim));
  CHECK(test::error_text([] {
          read("cos\nsystem\n.", 1, 1, {1, 2});
        }).find("os.system") != std::string::npos);
}

TEST_CASE("hostile pickles") {
  const auto refused = [](const std::string& pickle) {
    return test::error_kind([&] { read(pickle, 1, 1, {1, 2}); }) == ErrorKind::data;
  };
  const std::string whole = table(1, "K\0](K\0e"sv);
  for (size_t size = 0; size < whole.size(); ++size) REQUIRE(refused(whole.substr(0, size)));
  CHECK(refused(whole + "."));
  CHECK(refused("\x80\6N."s));
  CHECK(refused("."));
  CHECK(refused("N."));
  CHECK(refused("NN."));
  CHECK(refused("(N."));
  CHECK(refused("e."));
  CHECK(refused("t."));
  CHECK(refused("a."));
  CHECK(refused("Na."));
  CHECK(refused("\x87."s));
  CHECK(refused("R."));
  CHECK(refused("NR."));
  CHECK(refused(")R."));
  CHECK(refused("N)R."));
  CHECK(refused("b."));
  CHECK(refused(")b."));
  CHECK(refused("h\1."));
  CHECK(refused("q\1."));
  CHECK(refused("X\377\377\377\377."));
  CHECK(refused("C\377."));
  CHECK(refused("\x8a\377."));
  CHECK(refused("\x95\1\0\0\0\0\0\0\0."s));
  CHECK(refused("cnumpy"));
  CHECK(refused("]q\1h\1a."s));                                          // a list that holds itself
  CHECK(refused("cnumpy\nndarray\n)R."s));                               // calls a type
  CHECK(refused(kArray + "."));                                          // never given a state
  CHECK(refused(kArray + "(K\1K\1K\2\x86" + kObjectType + "\x89]tb."));  // fewer items than shape
  CHECK(refused(kArray + "(K\1J\377\377\377\377K\2\x86" + kObjectType + "\x89]tb."));
}

TEST_CASE("a short pickle can't ask for much work") {
  // 200 rows that all name one list of 100 000 references, of which only 5 frames exist.
  std::string list = "](";
  for (int i = 0; i < 100000; ++i) list += "K\1"s;
  list += "e";
  std::string items = "K\0"s + list + "r\1\0\0\0"s;
  for (int i = 1; i < 200; ++i) items += "K"s + static_cast<char>(i) + "j\1\0\0\0"s;
  CHECK(test::error_text([&] {
          read(table(static_cast<char>(200), items), 200, 5, {200, 2});
        }).find("more than there are frames") != std::string::npos);
  // Thousands of arguments, taken again and again.
  std::string tuple = "(";
  for (int i = 0; i < 100; ++i) tuple += 'N';
  CHECK(test::error_text([&] {
          read("cnumpy\ndtype\n"s + tuple + "tR.", 1, 1, {1, 2});
        }).find("too long") != std::string::npos);
  // A text that is encoded again and again.
  std::string encoded = "X\x10\0\0\0"s + std::string(16, 'x') + "q\1"s;
  for (int i = 0; i < 100; ++i) encoded += "c_codecs\nencode\nh\1\x85R"s;
  CHECK(test::error_kind([&] { read(encoded + ".", 1, 1, {1, 2}); }) == ErrorKind::data);
}
