// What programs say of themselves: help, versions, and what may have been meant.
#include "common/help.h"

#include <sstream>

#include <catch2/catch.hpp>

#include "support.h"

using namespace vpr;
using test::run_program;

namespace {

const std::vector<std::vector<std::string>> kCommands = {{"vpr-train"},
                                                         {"vpr-train", "fastable"},
                                                         {"vpr-train", "fabmap"},
                                                         {"vpr-train", "info"},
                                                         {"vpr-train", "add"},
                                                         {"vpr-train", "export"},
                                                         {"vpr-query"},
                                                         {"vpr-eval"},
                                                         {"vpr-eval", "compare"},
                                                         {"vpr-eval", "convert"},
                                                         {"vpr-eval", "check"},
                                                         {"vpr-tune"},
                                                         {"vpr-tune", "fastable"},
                                                         {"vpr-tune", "fabmap"},
                                                         {"vpr-tune", "threshold"},
                                                         {"vpr-bench"},
                                                         {"vpr-bench", "matching"},
                                                         {"vpr-bench", "describe"},
                                                         {"vpr-bench", "fabmap"},
                                                         {"vpr-bench", "realtime"},
                                                         {"vpr-bench", "compare"},
                                                         {"vpr-synth"}};

test::RunOutcome run_command(std::vector<std::string> words, const std::string& flag) {
  const std::string program = words.front();
  words.erase(words.begin());
  words.push_back(flag);
  return run_program(program, words);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("no line of any help is longer than 100 columns; common options come last") {
  for (const std::vector<std::string>& words : kCommands) {
    const auto run = run_command(words, "--help");
    INFO(words.front() << " " << words.back());
    REQUIRE(run.exit_code == 0);
    for (const std::string& line : lines_of(run.out)) {
      INFO(line);
      CHECK(line.size() <= kHelpWidth);
    }
    const size_t common = run.out.find("\nCommon options:\n");
    REQUIRE(common != std::string::npos);
    CHECK(run.out.find("--version", common) != std::string::npos);
    CHECK(run.out.find("Example:\n") != std::string::npos);
    for (const std::string own : {"\nOptions:\n", "\nGround truth:\n", "\nPictures:\n"}) {
      const size_t at = run.out.find(own);
      if (at != std::string::npos) CHECK(at < common);
    }
  }
}

TEST_CASE("every command knows its version") {
  for (const std::vector<std::string>& words : kCommands) {
    const auto run = run_command(words, "--version");
    CHECK(run.exit_code == 0);
    CHECK(run.out.starts_with(words.front() + " "));
    CHECK(lines_of(run.out).size() == 1);
  }
}

TEST_CASE("a mistyped flag or command is named, with the nearest") {
  const auto said = [](const std::string& program, const std::vector<std::string>& words) {
    const auto run = run_program(program, words);
    CHECK(run.exit_code == 2);
    CHECK(lines_of(run.err).size() == 1);
    return run.err;
  };
  CHECK(said("vpr-query", {"x.vprdb", "--query", "q", "--cl", "10"}) ==
        "vpr-query: unknown flag --cl; did you mean --c-l? See vpr-query --help\n");
  CHECK(said("vpr-tune", {"fastable", "x.vprdb", "--cl=10"}) ==
        "vpr-tune: unknown flag --cl; did you mean --c-l? See vpr-tune fastable --help\n");
  CHECK(said("vpr-eval", {"r.json", "--ground", "x"}) ==
        "vpr-eval: unknown flag --ground; did you mean --ground-truth? See vpr-eval --help\n");
  CHECK(said("vpr-eval", {"r.json", "--nothing-like-it"}) ==
        "vpr-eval: unknown flag --nothing-like-it. See vpr-eval --help\n");
  CHECK(said("vpr-train", {"fastabel", "--train", "x"})
            .starts_with("vpr-train: unknown command fastabel; did you mean fastable?"));
}

TEST_CASE("a mistyped word for a ground truth is named, with the nearest; a missing file is one") {
  const auto word = run_program("vpr-eval", {"check", "algned"});
  CHECK(word.exit_code == 2);
  CHECK(word.err.find("did you mean aligned?") != std::string::npos);
  CHECK(run_program("vpr-eval", {"check", "aligned.csv"}).exit_code == 3);
}

TEST_CASE("help wraps between words, and examples so that a shell takes them") {
  CommandEntry command;
  command.description = "Does it.";
  command.arguments = {{"DB", "database", true}};
  command.flags = {
      {{"-o", "--output"}, "FILE", {}, std::string(60, 'x') + " yyyyyyyyyyyy", "Options", true},
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
            std::string(60, 'x') + "\n" + column +
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

TEST_CASE("the help of a command has its own examples, and not those of its program") {
  const std::string help = run_program("vpr-eval", {"compare", "--help"}).out;
  const size_t example = help.find("\nExample:\n");
  REQUIRE(example != std::string::npos);
  CHECK(help.find("Example:\n", example + 2) == std::string::npos);
  CHECK(help.find("vpr-eval result.json") == std::string::npos);
  CHECK(help.find("\n\nExit codes:\n", example) != std::string::npos);
}
