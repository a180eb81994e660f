// Help, versions, completions and suggestions.
#include <algorithm>
#include <map>

#include <catch2/catch.hpp>

#include "cli/world.h"
#include "common/parser.h"

using namespace vpr;
using namespace vpr::test;

namespace {

// Programs, and their commands.
const std::map<std::string, Words> kPrograms = {
    {"vpr-train", {"", " images", " descriptors", " fabmap", " info", " add", " export"}},
    {"vpr-query", {"", " live", " loops"}},
    {"vpr-eval", {"", " matrix", " loops", " compare", " convert", " check"}},
    {"vpr-tune", {"", " fastable", " fabmap", " threshold"}},
    {"vpr-bench", {"", " matching", " describe", " training", " fabmap", " realtime", " compare"}},
    {"vpr-synth", {""}}};

// The text that a command prints; it starts once.
const std::string& printed(const std::string& command) {
  static std::map<std::string, std::string> known;
  const auto [item, is_new] = known.try_emplace(command);
  if (is_new) item->second = run_ok(command).out;
  return item->second;
}

void check_help(const std::string& program, const std::string& command) {
  const std::string help = printed(program + command + " --help");
  const std::string brief = run_ok(program + command + " -h").out;
  const Words short_lines = lines_of(brief);
  INFO(brief << help);
  for (const std::string& line : joined(lines_of(help), short_lines))
    CHECK(line.size() <= kHelpWidth);
  const std::string version = run_ok(program + command + " --version").out;
  CHECK(version.starts_with(program + " "));
  CHECK(lines_of(version).size() == 1);
  const size_t common = help.find("\nCommon options:\n");
  REQUIRE(common != std::string::npos);
  CHECK(help.find("--version", common) != std::string::npos);
  CHECK(has(help, "Example:\n"));
  for (const std::string own : {"\nOptions:\n", "\nGround truth:\n", "\nPage and plots:\n"})
    CHECK((!has(help, own) || help.find(own) < common));
  CHECK(short_lines.size() <= 25);
  CHECK(has(brief, "\nExample:\n  " + program));
  CHECK(short_lines.back().ends_with(" --help"));
}

}  // namespace

TEST_CASE("every command has a version, a long help, and a short one of 25 lines, of 80 columns") {
  for (const auto& [program, commands] : kPrograms)
    for (const std::string& command : commands) check_help(program, command);
}

TEST_CASE("no help string begins with a preposition") {
  for (const auto& [program, commands] : kPrograms) {
    const Words lines = lines_of(printed(program + " --completion man"));
    for (size_t i = 1; i < lines.size(); ++i) {
      if (!lines[i - 1].starts_with("\\fB\\-")) continue;
      INFO(lines[i - 1] << ": " << lines[i]);
      for (const std::string word : {"with", "for", "by", "of", "in", "on", "from", "to", "at"})
        CHECK_FALSE(lines[i].starts_with(word + " "));
    }
  }
}

TEST_CASE("help wraps between words, and examples can be pasted into a shell") {
  CommandEntry command;
  command.description = "Does it.";
  command.arguments = {{{"DB"}, "", {}, "database", "", true}};
  command.flags = {
      {{"-o", "--output"}, "FILE", {}, std::string(40, 'x') + " yyyyyyyyyyyy", "Options", true},
      {{"--much-longer-than-the-column"}, "a|b", {"a", "b"}, "h", "Options", false}};
  command.sections = split_sections("Example:\n  prog " + std::string(60, 'a') + " --flag " +
                                    std::string(60, 'b') + "\n\nMethods:\n  fast   is fast");
  const std::string column(kHelpColumn, ' ');
  CHECK(help_text(command, "prog") ==
        "Does it.\n"
        "Usage: prog [OPTIONS] DB\n"
        "\nArguments:\n"
        "  DB                          database\n"
        "\nOptions:\n"
        "  -o,--output FILE            " +
            std::string(40, 'x') + "\n" + column +
            "yyyyyyyyyyyy (required)\n"
            "  --much-longer-than-the-column a|b\n" +
            column +
            "h\n"
            "\nExample:\n"
            "  prog " +
            std::string(60, 'a') + " --flag \\\n      " + std::string(60, 'b') +
            "\n"
            "\nMethods:\n"
            "  fast   is fast\n");
}

TEST_CASE("the help of a command has its own examples, without those of its program") {
  const std::string help = printed("vpr-eval compare --help");
  const size_t example = help.find("\nExample:\n");
  REQUIRE(example != std::string::npos);
  CHECK(help.find("Example:\n", example + 2) == std::string::npos);
  CHECK_FALSE(has(help, "vpr-eval result.json"));
  CHECK(help.find("\n\nExit codes:\n", example) != std::string::npos);
}

TEST_CASE("completions and manual pages of every program contain all its flags") {
  for (const auto& [program, commands] : kPrograms) {
    const std::string help = printed(program + " --help");
    for (const std::string kind : {"bash", "zsh", "fish", "man"}) {
      const std::string text = printed(program + " --completion " + kind);
      for (size_t at = 0; (at = help.find("\n  --", at)) != std::string::npos; ++at) {
        const size_t end = help.find_first_of(" \n,", at + 5);
        std::string name = help.substr(at + 5, end - at - 5);
        if (kind == "man")
          for (size_t dash = 0; (dash = name.find('-', dash)) != std::string::npos; dash += 2)
            name.replace(dash, 1, "\\-");
        if (kind == "fish") name = "-l " + name;
        INFO(program << " " << kind << " " << name);
        CHECK(has(text, name));
      }
    }
  }
  CHECK(run("vpr-synth --completion tcsh").exit_code == 2);
}

TEST_CASE("a manual page has no line that troff interprets as a request by mistake") {
  const Words known = {".TH", ".SH", ".SS", ".TP", ".PP", ".nf", ".fi", ".br"};
  for (const std::string& line : lines_of(printed("vpr-eval --completion man"))) {
    if (line.starts_with('.')) CHECK(std::ranges::count(known, line.substr(0, 3)) == 1);
    CHECK_FALSE(line.starts_with('\''));
  }
}
