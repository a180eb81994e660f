// Help, versions, completions and suggestions.
#include <algorithm>

#include <catch2/catch.hpp>

#include "cli/world.h"
#include "common/parser.h"

using namespace vpr;
using namespace vpr::test;

namespace {

const Words kPrograms = {"vpr-train", "vpr-query", "vpr-eval",
                         "vpr-tune",  "vpr-bench", "vpr-synth"};

const Words kCommands = {"vpr-train",
                         "vpr-train fastable",
                         "vpr-train fabmap",
                         "vpr-train info",
                         "vpr-train add",
                         "vpr-train export",
                         "vpr-train descriptors",
                         "vpr-query",
                         "vpr-query live",
                         "vpr-query loops",
                         "vpr-query matrix",
                         "vpr-query explain",
                         "vpr-eval",
                         "vpr-eval matrix",
                         "vpr-eval loops",
                         "vpr-eval report",
                         "vpr-eval compare",
                         "vpr-eval convert",
                         "vpr-eval check",
                         "vpr-tune",
                         "vpr-tune fastable",
                         "vpr-tune fabmap",
                         "vpr-tune calibrate",
                         "vpr-tune threshold",
                         "vpr-bench",
                         "vpr-bench matching",
                         "vpr-bench describe",
                         "vpr-bench fabmap",
                         "vpr-bench realtime",
                         "vpr-bench compare",
                         "vpr-synth"};

std::string program_of(const std::string& command) { return command.substr(0, command.find(' ')); }

}  // namespace

TEST_CASE("every command has a version, a long help, and a short one of 25 lines, of 80 columns") {
  for (const std::string& command : kCommands) {
    const std::string help = run_ok(command + " --help").out;
    const std::string brief = run_ok(command + " -h").out;
    const Words short_lines = lines_of(brief);
    INFO(brief << help);
    for (const std::string& line : joined(lines_of(help), short_lines))
      CHECK(line.size() <= kHelpWidth);
    const std::string version = run_ok(command + " --version").out;
    CHECK(version.starts_with(program_of(command) + " "));
    CHECK(lines_of(version).size() == 1);
    const size_t common = help.find("\nCommon options:\n");
    REQUIRE(common != std::string::npos);
    CHECK(help.find("--version", common) != std::string::npos);
    CHECK(has(help, "Example:\n"));
    for (const std::string own : {"\nOptions:\n", "\nGround truth:\n", "\nPage and plots:\n"})
      CHECK((!has(help, own) || help.find(own) < common));
    CHECK(short_lines.size() <= 25);
    CHECK(has(brief, "\nExample:\n  " + program_of(command)));
    CHECK(short_lines.back().ends_with(" --help"));
  }
}

TEST_CASE("no help string begins with a preposition") {
  for (const std::string& program : kPrograms) {
    const Words lines = lines_of(run_ok(program + " --completion man").out);
    for (size_t i = 1; i < lines.size(); ++i) {
      if (!lines[i - 1].starts_with("\\fB\\-")) continue;
      INFO(lines[i - 1] << ": " << lines[i]);
      for (const std::string word : {"with", "for", "by", "of", "in", "on", "from", "to", "at"})
        CHECK_FALSE(lines[i].starts_with(word + " "));
    }
  }
}

TEST_CASE("a mistyped flag or command is reported with the nearest one") {
  check_refused(
      "", {{"vpr-query x.vprdb --query q --cl 10", 2,
            "vpr-query: unknown flag --cl; did you mean --c-l? See vpr-query --help\n"},
           {"vpr-tune fastable x.vprdb --cl=10", 2,
            "vpr-tune: unknown flag --cl; did you mean --c-l? See vpr-tune fastable --help\n"},
           {"vpr-eval r.json --ground x", 2,
            "vpr-eval: unknown flag --ground; did you mean --ground-truth? See vpr-eval --help\n"},
           {"vpr-eval r.json --nothing-like-it", 2,
            "vpr-eval: unknown flag --nothing-like-it. See vpr-eval --help\n"},
           {"vpr-train fastabel --train x", 2,
            "vpr-train: unknown command fastabel; did you mean fastable?"},
           {"vpr-eval check algned", 2, "did you mean aligned?"},
           {"vpr-eval check aligned.csv", 3, "aligned.csv"}});
}

TEST_CASE("help wraps between words, and examples can be pasted into a shell") {
  CommandEntry command;
  command.description = "Does it.";
  command.arguments = {{"DB", "database", true}};
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
  const std::string help = run_ok("vpr-eval compare --help").out;
  const size_t example = help.find("\nExample:\n");
  REQUIRE(example != std::string::npos);
  CHECK(help.find("Example:\n", example + 2) == std::string::npos);
  CHECK_FALSE(has(help, "vpr-eval result.json"));
  CHECK(help.find("\n\nExit codes:\n", example) != std::string::npos);
}

TEST_CASE("completions and manual pages of every program contain all its flags") {
  for (const std::string& program : kPrograms) {
    const std::string help = run_ok(program + " --help").out;
    for (const std::string kind : {"bash", "zsh", "fish", "man"}) {
      const auto outcome = run_ok(program + " --completion " + kind);
      for (size_t at = 0; (at = help.find("\n  --", at)) != std::string::npos; ++at) {
        const size_t end = help.find_first_of(" \n,", at + 5);
        std::string name = help.substr(at + 5, end - at - 5);
        if (kind == "man")
          for (size_t dash = 0; (dash = name.find('-', dash)) != std::string::npos; dash += 2)
            name.replace(dash, 1, "\\-");
        if (kind == "fish") name = "-l " + name;
        INFO(program << " " << kind << " " << name);
        CHECK(has(outcome.out, name));
      }
    }
    CHECK(run(program + " --completion tcsh").exit_code == 2);
  }
}

TEST_CASE("a manual page has no line that troff interprets as a request by mistake") {
  const std::string page = run_ok("vpr-eval --completion man").out;
  size_t begin = 0;
  while (begin < page.size()) {
    const size_t end = page.find('\n', begin);
    const std::string line = page.substr(begin, end - begin);
    if (!line.empty() && line[0] == '.') {
      const std::string request = line.substr(0, 3);
      const Words known = {".TH", ".SH", ".SS", ".TP", ".PP", ".nf", ".fi", ".br"};
      CHECK(std::find(known.begin(), known.end(), request) != known.end());
    }
    CHECK((line.empty() || line[0] != '\''));
    begin = end + 1;
  }
}
