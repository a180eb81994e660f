#include "base/output_transaction.h"

#include <algorithm>
#include <csignal>

#include <catch2/catch.hpp>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support.h"

using namespace vpr;
namespace fs = std::filesystem;

namespace {

using Names = std::vector<std::string>;

bool holds_note(const fs::path& folder) {
  return holds_only_files(folder, [](const std::string& name) { return name == "note"; });
}

// Runs `work` in a process of its own; it kills itself.
template <class Work>
void run_and_kill(Work&& work) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    work();
    ::_exit(1);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));
}

}  // namespace

TEST_CASE("outputs of a run appear together, the main one last in its place") {
  const test::TemporaryFolder folder;
  OutputTransaction outputs(Existing::refuse);
  outputs.claim_file(folder / "main.json");
  outputs.claim_file(folder / "page.html");
  outputs.claim_file(folder / "never.png");
  outputs.file(folder / "page.html").write("page");
  outputs.file(folder / "main.json").write("main");
  write_part(outputs.folder(folder / "plots", is_marked_folder).temporary() / "a.png", "a");
  for (const std::string& name : test::list_folder(folder.path()))
    CHECK(name.starts_with(".vpr-partial-"));
  outputs.commit();
  CHECK(test::list_folder(folder.path()) == Names{"main.json", "page.html", "plots"});
  CHECK(test::read_text(folder / "main.json") == "main");
  CHECK(test::list_folder(folder / "plots") == Names{".vpr-files", "a.png"});
}

TEST_CASE("without a commit, everything is as it was") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "a", "old");
  {
    OutputTransaction outputs(Existing::replace);
    outputs.file(folder / "a").write("new");
    outputs.file(folder / "b").write("new");
  }
  CHECK(test::list_folder(folder.path()) == Names{"a"});
  CHECK(test::read_text(folder / "a") == "old");
}

TEST_CASE("if one output can't be put in its place, all the old ones are back") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "main", "old main");
  test::write_text(folder / "companion", "old companion");
  fs::create_directory(folder / "db");
  test::write_text(folder / "db/note", "old note");
  {
    OutputTransaction outputs(Existing::replace);
    OutputFile& main = outputs.file(folder / "main");
    main.write("new main");
    outputs.file(folder / "companion").write("new companion");
    outputs.file(folder / "fresh").write("was not there");
    write_part(outputs.folder(folder / "db", holds_note).temporary() / "note", "new note");
    fs::remove(main.temporary());  // so that the last of all renames fails
    CHECK(test::error_kind([&] { outputs.commit(); }) == ErrorKind::output);
  }
  CHECK(test::list_folder(folder.path()) == Names{"companion", "db", "main"});
  CHECK(test::read_text(folder / "main") == "old main");
  CHECK(test::read_text(folder / "companion") == "old companion");
  CHECK(test::read_text(folder / "db/note") == "old note");
}

TEST_CASE("a target that comes into being meanwhile stays, and so do all others") {
  const test::TemporaryFolder folder;
  {
    OutputTransaction outputs(Existing::refuse);
    outputs.file(folder / "main").write("mine");
    outputs.file(folder / "companion").write("mine");
    test::write_text(folder / "main", "another's");
    CHECK(test::error_kind([&] { outputs.commit(); }) == ErrorKind::usage);
  }
  CHECK(test::list_folder(folder.path()) == Names{"main"});
  CHECK(test::read_text(folder / "main") == "another's");
}

TEST_CASE("what can't be written is found out when it is claimed") {
  const test::TemporaryFolder folder;
  OutputTransaction outputs(Existing::refuse);
  const auto claim = [&](const std::string& name) {
    return test::error_kind([&] { outputs.claim_file(folder / name); });
  };
  CHECK(claim("no/a") == ErrorKind::output);
  CHECK(claim(std::string(256, 'x')) == ErrorKind::output);
  CHECK_FALSE(claim(std::string(255, 'x')));
  outputs.file(folder / std::string(255, 'x')).write("long");
  outputs.commit();
  CHECK(test::read_text(folder / std::string(255, 'x')) == "long");
}

TEST_CASE("a folder that is not one's own is found out when an output in it is claimed") {
  const test::TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms(0755));
  for (const auto& [name, mode] : {std::pair("open", 0777), std::pair("closed", 0555)}) {
    fs::create_directory(folder / name);
    fs::permissions(folder / name, fs::perms(mode));
  }
  const uid_t user = ::geteuid();
  if (user == 0) REQUIRE(::seteuid(65534) == 0);  // root may write everywhere
  const auto claim = [&](const std::string& name) {
    OutputTransaction outputs(Existing::refuse);
    return test::error_kind([&] { outputs.claim_file(folder / name); });
  };
  const auto open = claim("open/a");
  const auto closed = claim("closed/a");
  REQUIRE(::seteuid(user) == 0);
  CHECK_FALSE(open);
  CHECK(closed == ErrorKind::output);
}

TEST_CASE("one path for two outputs is refused, whatever it is called") {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "sub");
  OutputTransaction outputs(Existing::replace);
  outputs.claim_file(folder / "a");
  for (const char* name : {"a", "sub/../a", "./a"})
    CHECK(test::error_kind([&] { outputs.claim_file(folder / name); }) == ErrorKind::usage);
  CHECK(test::error_kind([&] { outputs.claim_folder(folder / "a/", is_marked_folder); }) ==
        ErrorKind::usage);
  outputs.file(folder / "a");
  CHECK(test::error_kind([&] { outputs.file(folder / "a"); }) == ErrorKind::usage);
}

TEST_CASE("an input is no output, by any of its names, before or after it is claimed") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "gt.csv", "labels");
  fs::create_symlink("gt.csv", folder / "link.csv");
  OutputTransaction outputs(Existing::replace);
  outputs.protect(folder / "link.csv");
  outputs.protect(folder / "none");
  CHECK(test::error_kind([&] { outputs.claim_file(folder / "gt.csv"); }) == ErrorKind::usage);
  fs::create_directories(folder / "db/walk");
  test::write_text(folder / "db/note", "old");
  outputs.protect(folder / "db/walk");
  CHECK(test::error_text([&] {
          outputs.claim_folder(folder / "db", [](const fs::path&) { return true; });
        }).find("holds an input") != std::string::npos);
  outputs.release(folder / "db");
  outputs.claim_folder(folder / "db", [](const fs::path&) { return true; });
  test::write_text(folder / "later.csv", "labels");
  outputs.claim_file(folder / "later.csv");
  CHECK(test::error_kind([&] { outputs.protect(folder / "later.csv"); }) == ErrorKind::usage);
}

TEST_CASE("a folder that is extended in place is replaced with the other outputs, or not at all") {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "db");
  test::write_text(folder / "db/note", "old");
  const auto extend = [&](const std::string& text, bool somebody_is_faster) {
    OutputTransaction outputs(Existing::refuse);
    outputs.protect(folder / "db");
    outputs.extend(folder / "db/");
    outputs.claim_file(folder / "list");
    outputs.claim_folder(folder / "db", holds_note);
    write_part(outputs.folder(folder / "db", holds_note).temporary() / "note", text);
    outputs.file(folder / "list").write(text);
    CHECK(outputs.has_outputs());
    if (somebody_is_faster) test::write_text(folder / "list", "another's");
    outputs.commit();
    CHECK_FALSE(outputs.has_outputs());
  };
  CHECK(test::error_kind([&] { extend("new", true); }) == ErrorKind::usage);
  CHECK(test::read_text(folder / "db/note") == "old");
  fs::remove(folder / "list");
  extend("new", false);
  CHECK(test::read_text(folder / "db/note") == "new");
  CHECK(test::list_folder(folder.path()) == Names{"db", "list"});
}

TEST_CASE("temporaries can't be foreseen, and are made through no link") {
  const test::TemporaryFolder folder;
  const OutputFile a(folder / "a", Existing::refuse);
  const OutputFile same(folder / "a", Existing::refuse);
  CHECK(a.temporary() != same.temporary());
  CHECK(a.temporary().filename().string().size() < 60);
  test::write_text(folder / "victim", "mine");
  fs::create_symlink("victim", folder / "link");
  CHECK(test::error_kind([&] { write_part(folder / "link", "x"); }) == ErrorKind::output);
  CHECK(test::read_text(folder / "victim") == "mine");
}

TEST_CASE(
    "what a killed process left is removed by the next one, what a living one writes is not") {
  const test::TemporaryFolder folder;
  run_and_kill([&] {
    OutputTransaction outputs(Existing::refuse);
    outputs.file(folder / "a").write("half");
    write_part(outputs.folder(folder / "plots", is_marked_folder).temporary() / "p.png", "half");
    outputs.claim_file(folder / "other");
    ::raise(SIGKILL);
  });
  CHECK(test::list_folder(folder.path()).size() == 3);
  OutputTransaction living(Existing::refuse);
  living.file(folder / "a").write("mine");
  living.claim_folder(folder / "plots", is_marked_folder);
  CHECK(test::list_folder(folder.path()).size() == 3);  // two, and what was left of "other"
  OutputTransaction second(Existing::refuse);
  second.claim_file(folder / "a");
  second.claim_file(folder / "other");
  CHECK(test::list_folder(folder.path()).size() == 4);
  living.commit();
  CHECK(test::read_text(folder / "a") == "mine");
}

TEST_CASE("a marked folder is replaced only while nothing else lies in it") {
  const test::TemporaryFolder folder;
  const auto write = [&](const std::string& name) {
    OutputFolder output(folder / "plots", Existing::replace, is_marked_folder);
    write_part(output.temporary() / name, "x");
    output.commit();
  };
  write("a.png");
  write("b.png");
  CHECK(test::list_folder(folder / "plots") == Names{".vpr-files", "b.png"});
  test::write_text(folder / "plots/c.png", "mine");
  CHECK(test::error_kind([&] { write("a.png"); }) == ErrorKind::usage);
  fs::remove(folder / "plots/c.png");
  fs::remove(folder / "plots/b.png");
  fs::create_directories(folder / "plots/b.png/thesis");
  CHECK(test::error_kind([&] { write("a.png"); }) == ErrorKind::usage);
  CHECK(fs::exists(folder / "plots/b.png/thesis"));
  fs::create_directory(folder / "frames");
  test::write_text(folder / "frames/0.png", "mine");
  CHECK(test::error_kind([&] {
          OutputFolder(folder / "frames", Existing::replace, is_marked_folder);
        }) == ErrorKind::usage);
}

TEST_CASE("an error says the name of an output, not that under which it is being made") {
  const test::TemporaryFolder folder;
  OutputTransaction outputs(Existing::refuse);
  outputs.claim_file(folder / "main");
  const OutputFolder& plots = outputs.folder(folder / "plots", is_marked_folder);
  const std::string sentence =
      test::error_text([&] { write_part(plots.temporary() / "none/a.png", "x"); });
  CHECK(sentence.find(".vpr-partial-") != std::string::npos);
  CHECK(outputs.with_targets(sentence) ==
        (folder / "plots/none/a.png").string() + ": can't be written: No such file or directory");
}

TEST_CASE("folders that can't be made or read are errors of output") {
  const test::TemporaryFolder folder;
  make_part_folder(folder / "a");
  for (const char* name : {"a", "none/b"})
    CHECK(test::error_kind([&] { make_part_folder(folder / name); }) == ErrorKind::output);
  CHECK(test::error_kind([&] { entries_of(folder / "none"); }) == ErrorKind::output);
  CHECK(test::error_kind([&] { holds_note(folder / "none"); }) == ErrorKind::output);
  CHECK(entries_of(folder.path()).size() == 1);
}

TEST_CASE("an old output that was set aside is put back, unless it was replaced") {
  const test::TemporaryFolder folder;
  const fs::path temporary = OutputFile(folder / "a", Existing::refuse).temporary();
  test::write_text(name_aside(temporary), "old");
  clean_up(folder / "a");
  CHECK(test::list_folder(folder.path()) == Names{"a"});
  test::write_text(name_aside(temporary), "older");
  clean_up(folder / "a");
  CHECK(test::list_folder(folder.path()) == Names{"a"});
  CHECK(test::read_text(folder / "a") == "old");
}
