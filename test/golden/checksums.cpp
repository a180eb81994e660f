#include "golden/checksums.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/checksum.h"
#include "support.h"

namespace vpr::test {
namespace {

std::filesystem::path crc_path(const std::string& name) {
  return source_path("test/golden/" + name + ".crc");
}

bool wants_writing() {
  const char* mode = std::getenv("VPR_GOLDEN");
  return mode != nullptr && std::string(mode) == "write";
}

}  // namespace

std::vector<FrameChecksum> read_checksums(const std::string& name) {
  std::vector<FrameChecksum> lines;
  std::istringstream text(read_text(crc_path(name)));
  for (std::string line; std::getline(text, line);) {
    const size_t end = line.find(": ");
    if (line.starts_with('#') || end == std::string::npos) continue;
    lines.push_back({line.substr(0, end), line.substr(end + 2)});
  }
  return lines;
}

std::string first_change(const std::string& name, const std::vector<FrameChecksum>& expected,
                         const std::vector<FrameChecksum>& found) {
  const size_t common = std::min(expected.size(), found.size());
  size_t first = common;
  size_t changed = std::max(expected.size(), found.size()) - common;
  for (size_t i = common; i-- > 0;) {
    if (expected[i].frame == found[i].frame && expected[i].text == found[i].text) continue;
    first = i;
    ++changed;
  }
  if (changed == 0) return "";
  const auto at = [&](const std::vector<FrameChecksum>& lines) {
    return first < lines.size() ? lines[first].frame + ": " + lines[first].text : "nothing";
  };
  return fmt::format(
      "test/golden/{}.crc: {} of {} lines changed, the first from \"{}\" to \"{}\"; if that is "
      "meant, run scripts/generate.sh and say why in the commit",
      name, changed, expected.size(), at(expected), at(found));
}

void check_golden(const std::string& name, const std::string& what,
                  const std::vector<FrameChecksum>& found) {
  if (!wants_writing()) {
    CHECK(first_change(name, read_checksums(name), found) == "");
    return;
  }
  std::string text = fmt::format("# {}\n# Made by scripts/generate.sh.\n", what);
  for (const FrameChecksum& line : found) text += fmt::format("{}: {}\n", line.frame, line.text);
  write_text(crc_path(name), text);
}

std::string short_checksum(std::span<const std::byte> bytes) {
  return checksum(bytes).substr(std::string_view("xxh3:").size(), 8);
}

}  // namespace vpr::test
