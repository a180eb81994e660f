// What programs say of their own flags, for completions and manual pages.
#include <algorithm>

#include <catch2/catch.hpp>

#include "support.h"

using namespace vpr;
using test::run_program;

TEST_CASE("every program writes completions and a manual page that know all its flags") {
  for (const std::string program :
       {"vpr-train", "vpr-query", "vpr-eval", "vpr-tune", "vpr-bench", "vpr-synth"}) {
    const std::string help = run_program(program, {"--help"}).out;
    for (const std::string kind : {"bash", "man"}) {
      const auto run = run_program(program, {"--completion", kind});
      CHECK(run.exit_code == 0);
      for (size_t at = 0; (at = help.find("\n  --", at)) != std::string::npos; ++at) {
        const size_t end = help.find_first_of(" \n,", at + 5);
        std::string name = help.substr(at + 5, end - at - 5);
        if (kind == "man")
          for (size_t dash = 0; (dash = name.find('-', dash)) != std::string::npos; dash += 2)
            name.replace(dash, 1, "\\-");
        INFO(program << " " << kind << " " << name);
        CHECK(run.out.find(name) != std::string::npos);
      }
    }
    CHECK(run_program(program, {"--completion", "zsh"}).exit_code == 2);
  }
}

TEST_CASE("a manual page has no line that troff would take for a request by mistake") {
  const std::string page = run_program("vpr-eval", {"--completion", "man"}).out;
  size_t begin = 0;
  while (begin < page.size()) {
    const size_t end = page.find('\n', begin);
    const std::string line = page.substr(begin, end - begin);
    if (!line.empty() && line[0] == '.') {
      const std::string request = line.substr(0, 3);
      const std::vector<std::string> known = {".TH", ".SH", ".SS", ".TP",
                                              ".PP", ".nf", ".fi", ".br"};
      CHECK(std::find(known.begin(), known.end(), request) != known.end());
    }
    CHECK((line.empty() || line[0] != '\''));
    begin = end + 1;
  }
}
