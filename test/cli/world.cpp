#include "cli/world.h"

#include <algorithm>
#include <map>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/text.h"
#include "cli/building.h"

namespace vpr::test {
namespace {

// The data set with two training walks and one query.
void write_two_walks(const std::string& from, const std::string& to) {
  Json dataset = Json::parse(read_text(from));
  const auto keep = [&](const char* list, const Words& names) {
    Json kept = Json::array();
    for (const Json& item : dataset[list])
      if (std::find(names.begin(), names.end(), item["name"].get<std::string>()) != names.end())
        kept.push_back(item);
    dataset[list] = kept;
  };
  keep("train", {"one", "two"});
  keep("queries", {"back"});
  write_text(to, dataset.dump());
}

std::string path_of(const std::string& name) {
  if (name == "db") return world().database();
  if (name == "fabmap") return world().fabmap();
  if (name == "dataset") return world().dataset();
  if (name == "truth") return world().truth("back");
  return world().walk(name == "walk" ? "" : name);
}

}  // namespace

World::World() {
  write_text(folder_ / "world.json", building(3, {"one", "two", "other", "back", "again"}));
  const std::string root = folder_.path().string() + "/";
  run_ok("vpr-synth " + root + "world.json -o " + root + "walk");
  write_two_walks(walk("dataset.json"), dataset());
  run_ok("vpr-train fastable --c-l 10 --dataset " + dataset() + " -o " + database());
  run_ok("vpr-train fabmap --features sift --words 60 --pretrain " + walk("other") + " --train " +
         walk("one") + " -o " + fabmap());
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
  const auto lines = split_lines(text);
  return {lines.begin(), lines.end()};
}

void start_with(void (*make)()) {
  static std::map<void (*)(), TemporaryFolder> made;
  const auto here = std::filesystem::current_path();
  const auto [folder, is_new] = made.try_emplace(make);
  if (is_new) {
    std::filesystem::current_path(folder->second.path());
    make();
    std::filesystem::current_path(here);
  }
  std::filesystem::copy(folder->second.path(), here, std::filesystem::copy_options::recursive);
}

void write_walk(const std::string& name, size_t count, uint64_t seed, int width, int height) {
  std::filesystem::create_directory(name);
  for (size_t i = 0; i < count; ++i)
    write_image(fmt::format("{}/{:02}.png", name, i), seed + i, width, height);
}

Words words_of(const std::string& command) {
  Words words;
  bool is_quoted = false;
  bool starts = true;
  for (const char c : command) {
    if (c == '\'') is_quoted = !is_quoted;
    if (c == ' ' && !is_quoted) {
      starts = true;
      continue;
    }
    if (starts) words.emplace_back();
    starts = false;
    if (c != '\'') words.back() += c;
  }
  for (std::string& word : words)
    for (size_t at = 0; (at = word.find('$', at)) != std::string::npos;) {
      const size_t end = std::min(word.find_first_of("./@", at), word.size());
      const std::string path = path_of(word.substr(at + 1, end - at - 1));
      word.replace(at, end - at, path);
      at += path.size();
    }
  return words;
}

RunOutcome run(const std::string& command, const std::string& environment) {
  Words words = words_of(command);
  const std::string program = words.front();
  words.erase(words.begin());
  return run_program(program, words, environment.empty() ? Words{} : Words{environment});
}

RunOutcome run_ok(const std::string& command, const std::string& environment) {
  return ok(run(command, environment));
}

Json printed_json(const std::string& command) { return printed_json(run(command)); }

Json comparable(Json json) {
  for (const char* part : {"machine", "timing"}) json.erase(part);
  return json;
}

void check_screen(const std::string& text, size_t most_lines) {
  INFO(text);
  const Words lines = lines_of(text);
  CHECK(lines.size() <= most_lines);
  for (const std::string& line : lines) {
    const size_t word = line.find_first_not_of(' ');
    CHECK((line.size() <= 80 || line.find(' ', word) == line.rfind(" \\")));
  }
}

void check_failure(const RunOutcome& outcome, int exit_code, const std::string& word) {
  INFO(outcome.err);
  REQUIRE_FALSE(word.empty());
  CHECK(outcome.exit_code == exit_code);
  CHECK(has(outcome.err, word));
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
}

void check_failure(const std::string& command, int exit_code, const std::string& word) {
  INFO(command);
  const RunOutcome outcome = run(command);
  CHECK(outcome.out.empty());
  check_failure(outcome, exit_code, word);
}

}  // namespace vpr::test
