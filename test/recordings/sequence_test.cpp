// Image sequences: folders, lists, ranges and names.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/text.h"
#include "recordings/sequence_source.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

TEST_CASE("runs of digits compare by value, other characters by byte") {
  std::vector<std::string> names = {"10.jpg", "2.jpg", "a10b2",   "a2b10",  "1.jpg",
                                    "B",      "a",     "010.jpg", "a10b10", "\xc3\xa4"};
  std::sort(names.begin(), names.end(), natural_less);
  CHECK(names == std::vector<std::string>{"1.jpg", "2.jpg", "10.jpg", "010.jpg", "B", "a", "a2b10",
                                          "a10b2", "a10b10", "\xc3\xa4"});
}

TEST_CASE("numbers of any length compare by value") {
  CHECK(natural_less("f99999999999999999999998", "f99999999999999999999999"));
  CHECK(natural_less("f9", "f100000000000000000000000000"));
  CHECK(natural_less("f00000000000000000000000000", "f1"));
}

TEST_CASE("the order is strict and total") {
  const std::vector<std::string> names = {"",   "0",  "00", "1",   "01",    "a",     "a0",  "a00",
                                          "a1", "0a", "1a", "01a", "a01b1", "a1b01", "a1b1"};
  for (const auto& a : names) {
    CHECK_FALSE(natural_less(a, a));
    for (const auto& b : names) {
      if (a != b) CHECK(natural_less(a, b) != natural_less(b, a));
      for (const auto& c : names)
        if (natural_less(a, b) && natural_less(b, c)) REQUIRE(natural_less(a, c));
    }
  }
}

TEST_CASE("a range is separated from the path") {
  const SequenceArgument all = parse_sequence_argument("walk");
  CHECK((all.path == "walk" && all.range.is_all()));
  const SequenceArgument part = parse_sequence_argument("walk@10:20:3");
  CHECK((part.path == "walk" && part.range == FrameRange{10, 20, 3}));
  CHECK(parse_sequence_argument("walk@:20").range == FrameRange{0, 20, 1});
  CHECK(parse_sequence_argument("walk@5:").range == FrameRange{5, std::nullopt, 1});
  CHECK(parse_sequence_argument("walk@::2").range == FrameRange{0, std::nullopt, 2});
  CHECK(range_text({10, 20, 3}) == "@10:20:3");
  CHECK(range_text({0, std::nullopt, 2}) == "@0::2");
}

TEST_CASE("an at sign that starts no range is part of the path") {
  CHECK(parse_sequence_argument("me@home").path == "me@home");
  CHECK(parse_sequence_argument("a@1").path == "a@1");
  CHECK(parse_sequence_argument("a@1:2:3:4").path == "a@1:2:3:4");
}

TEST_CASE("a path that exists as written takes precedence over a range") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "walk@1:2");
  CHECK(parse_sequence_argument((folder / "walk@1:2").string()).range.is_all());
}

TEST_CASE("invalid ranges are usage errors") {
  const std::string text =
      GENERATE("w@5:5", "w@6:5", "w@0:9:0", "w@0:99999999999999999999", "w@18446744073709551615:");
  CHECK(error_kind([&] { parse_sequence_argument(text); }) == ErrorKind::usage);
}

TEST_CASE("a folder yields its images in natural order and nothing else") {
  const TemporaryFolder folder;
  for (const char* name : {"10.png", "2.JPG", "1.jpeg", ".hidden.png", "notes.txt", "a.mp4"})
    write_text(folder / name, "");
  fs::create_directory(folder / "sub.png");
  CHECK(file_names(open_sequence({folder.path(), {}})) ==
        std::vector<std::string>{"1.jpeg", "2.JPG", "10.png"});
  CHECK(file_names(open_sequence({folder.path(), {0, 3, 2}})) ==
        std::vector<std::string>{"1.jpeg", "10.png"});
  CHECK(error_kind([&] { open_sequence({folder.path(), {0, 4, 1}}); }) == ErrorKind::usage);
  CHECK(error_kind([&] {
          open_sequence({folder.path(), {3, std::nullopt, 1}});
        }) == ErrorKind::usage);
}

TEST_CASE("a step beyond the end selects one frame") {
  const TemporaryFolder folder;
  for (const char* name : {"1.png", "2.png"}) write_text(folder / name, "");
  const SequenceArgument argument{folder.path(), {1, std::nullopt, uint64_t{1} << 62}};
  CHECK(file_names(open_sequence(argument)) == std::vector<std::string>{"2.png"});
}

TEST_CASE("a list yields its files in its own order, relative to its folder") {
  write_text("list.txt", "# two frames, one by Windows\r\nb\\2.png\r\n\na/1.png");
  fs::create_directory("a");
  write_text("a/1.png", "");
  const SequenceSource sequence = open_sequence({"list.txt", {}});
  CHECK(sequence.files == std::vector<fs::path>{"b/2.png", "a/1.png"});
}

TEST_CASE("backslashes of Windows separate folders") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "a/b");
  write_text(folder / "a/b/1.png", "");
  write_text(folder / "c\\2.png", "");
  write_text(folder / "list.txt", "a\\b\\1.png\r\nc\\2.png\r\n");
  const SequenceSource sequence = open_sequence({folder / "list.txt", {}});
  CHECK(sequence.files == std::vector<fs::path>{folder / "a/b/1.png", folder / "c\\2.png"});
  const FrameNames names({"x/1.png", "y/1.png", "c\\2.png"});
  CHECK(names.find("z\\y\\1.png") == size_t{1});
  CHECK(names.find("c\\2.png") == size_t{2});
  CHECK_FALSE(names.find("z\\3.png"));
}

TEST_CASE("the images of a list may be a column with a header") {
  const TemporaryFolder folder;
  for (const char* name : {"1.png", "b c.png"}) write_text(folder / name, "");
  const fs::path list = folder / "list.csv";
  const std::vector<fs::path> images = {folder / "1.png", folder / "b c.png"};
  for (const char* text :
       {"image\n1.png\nb c.png\n", "time,Filename\n1.5,1.png\n2.5,b c.png\n",
        ",path\n0,1.png\n1,\"b c.png\"\n", "# timestamp filename\n1.5 1.png\n2.5 \"b c.png\"\n"}) {
    write_text(list, text);
    CHECK(open_sequence({list, {}}).files == images);
  }
  write_text(folder / "image", "");
  write_text(list, "image\n1.png\n");
  CHECK(open_sequence({list, {}}).files == std::vector{folder / "image", folder / "1.png"});
  write_text(list, "photo 1\nphoto 2\n");
  CHECK(known_frame_names({list, {}}) == std::vector<std::string>{"photo 1", "photo 2"});
}

TEST_CASE("a byte order mark before a list is not part of a name") {
  write_text("list.txt", "\xef\xbb\xbf\x31.png\r\n2.png\r\n");
  write_text("1.png", "");
  const SequenceSource sequence = open_sequence({"list.txt", {}});
  CHECK(sequence.files == std::vector<fs::path>{"1.png", "2.png"});
}

TEST_CASE("a missing array is reported as a missing file") {
  const auto text = [](const char* path) { return error_text([&] { open_sequence({path, {}}); }); };
  CHECK(text("/off_map/db.npy") == "/off_map/db.npy: no such file");
  CHECK(text("/off_map") == "/off_map: no such folder, list or video");
}

TEST_CASE("a path that is not a sequence is an input error with its name") {
  const TemporaryFolder folder;
  write_text(folder / "empty.txt", "\n#\n");
  write_text(folder / "pairs.csv", "query,reference\n1,2\n");
  write_text(folder / "binary.txt", std::string("a\0b", 3));
  write_text(folder / "one.png", "");
  fs::create_directory(folder / "empty");
  const std::string name =
      GENERATE("empty.txt", "pairs.csv", "binary.txt", "one.png", "empty", "missing");
  const std::string text = error_text([&] { open_sequence({folder / name, {}}); });
  CHECK(has(text, name));
  CHECK(error_kind([&] { open_sequence({folder / name, {}}); }) == ErrorKind::input);
  CHECK(has(error_text([&] { frame_names({folder / "empty.txt", {}}); }), "names no images"));
}

TEST_CASE("an empty file, such as files in /proc, is not opened as a video") {
  write_text("walk.mp4", "");
  for (const fs::path& path : {fs::path("walk.mp4"), fs::path("/proc/kmsg")}) {
    if (!fs::exists(path)) continue;  // /proc/kmsg, in some containers
    CHECK(error_text([&] { open_sequence({path, {}}); }) == path.string() + ": is an empty file");
  }
}

TEST_CASE("arrays of other formats are not opened as videos") {
  for (const auto& [name, advice] :
       {std::pair("q.npz", "Save one as .npy"), std::pair("q.mat", "scripts/convert/mat.py")}) {
    write_text(name, "array");
    CHECK(has(error_text([&, path = name] { open_sequence({path, {}}); }), advice));
  }
}

TEST_CASE("sequences are named by their folder, with parents if two are equal") {
  const auto names = [](const std::vector<std::string>& texts) {
    std::vector<SequenceArgument> arguments;
    for (const auto& text : texts) arguments.push_back(parse_sequence_argument(text));
    return sequence_names(arguments);
  };
  CHECK(names({"/d/monday", "/d/tuesday/"}) == std::vector<std::string>{"monday", "tuesday"});
  CHECK(names({"/a/ref", "/b/ref", "/c"}) == std::vector<std::string>{"a/ref", "b/ref", "c"});
  CHECK(names({"/a/x/ref", "/b/x/ref"}) == std::vector<std::string>{"a/x/ref", "b/x/ref"});
  CHECK(names({"/a/w@0:5", "/a/w@5:9"}) == std::vector<std::string>{"w@0:5", "w@5:9"});
  CHECK(names({"/a/w@0:5"}) == std::vector<std::string>{"w@0:5"});
  CHECK(names({"/a/list.txt"}) == std::vector<std::string>{"list"});
  CHECK(names({"/a/w.txt", "/a/w.mp4"}) == std::vector<std::string>{"w.txt", "w.mp4"});
  CHECK(names({"/a/bad\xff"}) == std::vector<std::string>{"bad%FF"});
  CHECK(sequence_names({parse_sequence_argument("/a/w")}, {"w"}) ==
        std::vector<std::string>{"a/w"});
  CHECK(error_kind([&] { names({"/a/w", "/a/w"}); }) == ErrorKind::usage);
}

TEST_CASE("subfolders are sequences in natural order") {
  const TemporaryFolder folder;
  for (const char* name : {"w10", "w2", ".git"}) fs::create_directory(folder / name);
  write_text(folder / "file", "");
  const auto found = subfolder_arguments(folder.path());
  REQUIRE(found.size() == 2);
  CHECK(found[0].path == folder / "w2");
  CHECK(error_kind([&] { subfolder_arguments(folder / "w2"); }) == ErrorKind::input);
}
