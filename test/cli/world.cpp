#include "cli/world.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "cli/building.h"

namespace vpr::test {
namespace {

// The data set with two training walks and one query.
void write_two_walks(const std::string& from, const std::string& to) {
  Json dataset = Json::parse(read_text(from));
  const auto keep = [&](const char* list, const Words& names) {
    Json kept = Json::array();
    for (const Json& item : dataset[list])
      if (std::find(names.begin(), names.end(), item["name"]) != names.end()) kept.push_back(item);
    dataset[list] = kept;
  };
  keep("train", {"one", "two"});
  keep("queries", {"back"});
  write_text(to, dataset.dump());
}

}  // namespace

World::World() {
  write_text(folder_ / "world.json", building(3, {"one", "two", "other", "back", "again"}));
  run_ok("vpr-synth", {folder_ / "world.json", "-o", folder_ / "walk"});
  write_two_walks(walk("dataset.json"), dataset());
  run_ok("vpr-train", {"fastable", "--dataset", dataset(), "--c-l", "10", "-o", database()});
  run_ok("vpr-train", {"fabmap", "--pretrain", walk("other"), "--train", walk("one"), "--features",
                       "sift", "--words", "60", "-o", fabmap()});
}

std::string World::truth(const std::string& name) const {
  return folder_ / "walk" / (name + ".ground_truth.csv");
}

const World& world() {
  static const World kShared;
  return kShared;
}

Words images_of(const std::filesystem::path& walk) {
  Words names = list_folder(walk);
  std::erase_if(names, [](const std::string& name) { return !name.ends_with(".png"); });
  return names;
}

Words lines_of(const std::string& text) {
  Words lines;
  for (size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos;
       begin = end + 1)
    lines.push_back(text.substr(begin, end - begin));
  return lines;
}

void check_failure(const RunOutcome& outcome, int exit_code, const std::string& word) {
  INFO(outcome.err);
  REQUIRE_FALSE(word.empty());
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.err.find(word) != std::string::npos);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
}

void check_failure(const std::string& program, const Words& arguments, int exit_code,
                   const std::string& word) {
  check_failure(run_program(program, arguments), exit_code, word);
}

}  // namespace vpr::test
