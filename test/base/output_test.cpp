#include "base/output.h"

#include <csignal>
#include <thread>

#include <catch2/catch.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

using Names = std::vector<std::string>;

bool holds_note(const fs::path& folder) {
  return holds_only_files(folder, [](const std::string& name) { return name == "note"; });
}

void write_file(const fs::path& path, const std::string& text, Existing existing) {
  Outputs outputs(existing);
  outputs.file(path).write(text);
  outputs.commit();
}

// Runs `work` in a separate process, which kills itself.
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

TEST_CASE("all outputs of a run appear at once, the main one last") {
  const TemporaryFolder folder;
  Outputs outputs(Existing::refuse);
  outputs.claim_file(folder / "main.json");
  outputs.claim_file(folder / "page.html");
  outputs.claim_file(folder / "never.png");
  outputs.file(folder / "page.html").write("page");
  outputs.file(folder / "main.json").write("main");
  write_part(outputs.folder(folder / "plots", is_marked_folder).temporary() / "a.png", "a");
  for (const std::string& name : list_folder(folder.path()))
    CHECK(name.starts_with(".vpr-partial-"));
  outputs.commit();
  CHECK(list_folder(folder.path()) == Names{"main.json", "page.html", "plots"});
  CHECK(read_text(folder / "main.json") == "main");
  CHECK(list_folder(folder / "plots") == Names{".vpr-files", "a.png"});
}

TEST_CASE("without a commit, nothing changes") {
  const TemporaryFolder folder;
  write_text(folder / "a", "old");
  {
    Outputs outputs(Existing::replace);
    outputs.file(folder / "a").write("new");
    outputs.file(folder / "b").write("new");
  }
  CHECK(list_folder(folder.path()) == Names{"a"});
  CHECK(read_text(folder / "a") == "old");
}

TEST_CASE("an existing file is refused, both before the work and at its end") {
  const TemporaryFolder folder;
  Outputs late(Existing::refuse);
  late.file(folder / "a");
  write_text(folder / "a", "first");  // another program was faster
  CHECK(error_kind([&] { late.commit(); }) == ErrorKind::usage);
  CHECK(error_kind([&] { write_file(folder / "a", "x", Existing::refuse); }) == ErrorKind::usage);
  CHECK(read_text(folder / "a") == "first");
  write_file(folder / "a", "second", Existing::replace);
  CHECK(read_text(folder / "a") == "second");
}

TEST_CASE("a missing parent folder, or a folder with the name of an output file, is an error") {
  const TemporaryFolder folder;
  CHECK(error_kind([&] { Output(folder / "no/a", Existing::refuse); }) == ErrorKind::output);
  CHECK(error_kind([&] { Output(folder.path(), Existing::replace); }) == ErrorKind::usage);
}

TEST_CASE("a folder is replaced in one step, and only if it is an output of the program") {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& text, Existing existing) {
    Outputs outputs(existing);
    write_part(outputs.folder(folder / "db", holds_note).temporary() / "note", text);
    outputs.commit();
  };
  write("one", Existing::refuse);
  CHECK(error_kind([&] { write("two", Existing::refuse); }) == ErrorKind::usage);
  write("two", Existing::replace);
  CHECK(read_text(folder / "db/note") == "two");
  CHECK(list_folder(folder.path()) == Names{"db"});
  fs::create_directory(folder / "home");
  write_text(folder / "home/letter", "dear");
  CHECK(error_kind([&] { Output(folder / "home", Existing::replace, holds_note); }) ==
        ErrorKind::usage);
  CHECK(read_text(folder / "home/letter") == "dear");
}

TEST_CASE("a full disk is an output error") {
  if (!fs::exists("/dev/full")) return;
  Output file(fs::temp_directory_path() / "vpr-full-test", Existing::replace);
  CHECK(error_kind([&] { file.reserve(uint64_t{1} << 60); }) == ErrorKind::output);
}

TEST_CASE("a target that is not a regular file is not replaced") {
  const TemporaryFolder folder;
  fs::create_symlink("/dev/null", folder / "null");
  CHECK(error_kind([&] { write_file(folder / "null", "x", Existing::replace); }) ==
        ErrorKind::usage);
}

TEST_CASE("a target that another program creates during the run is kept") {
  const TemporaryFolder folder;
  {
    Outputs outputs(Existing::refuse);
    outputs.file(folder / "main").write("mine");
    outputs.file(folder / "companion").write("mine");
    write_text(folder / "main", "another's");
    CHECK(error_kind([&] { outputs.commit(); }) == ErrorKind::usage);
  }
  CHECK(list_folder(folder.path()) == Names{"main"});
  CHECK(read_text(folder / "main") == "another's");
}

TEST_CASE("two concurrent runs with the same outputs leave the outputs of one of them") {
  const TemporaryFolder folder;
  const Names names = {"main", "page", "plot", "list"};
  const auto run = [&](const std::string& text) {
    Outputs outputs(Existing::replace);
    for (const std::string& name : names) outputs.file(folder / name).write(text);
    outputs.commit();
  };
  run("first");
  for (int round = 0; round < 200; ++round) {
    std::thread other([&] { run("a"); });
    run("b");
    other.join();
    const std::string main = read_text(folder / "main");
    for (const std::string& name : names) REQUIRE(read_text(folder / name) == main);
  }
  CHECK(list_folder(folder.path()).size() == names.size());
}

TEST_CASE("an output that cannot be written is detected by claim_file") {
  const TemporaryFolder folder;
  Outputs outputs(Existing::refuse);
  const auto claim = [&](const std::string& name) {
    return error_kind([&] { outputs.claim_file(folder / name); });
  };
  CHECK(claim("no/a") == ErrorKind::output);
  CHECK(claim(std::string(256, 'x')) == ErrorKind::output);
  CHECK_FALSE(claim(std::string(255, 'x')));
  outputs.file(folder / std::string(255, 'x')).write("long");
  outputs.commit();
  CHECK(read_text(folder / std::string(255, 'x')) == "long");
}

TEST_CASE("a foreign folder is detected when an output in it is claimed") {
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms(0755));
  for (const auto& [name, mode] : {std::pair("open", 0777), std::pair("closed", 0555)}) {
    fs::create_directory(folder / name);
    fs::permissions(folder / name, fs::perms(mode));
  }
  const uid_t user = ::geteuid();
  if (user == 0) REQUIRE(::seteuid(65534) == 0);  // root may write everywhere
  const auto claim = [&](const std::string& name) {
    Outputs outputs(Existing::refuse);
    return error_kind([&] { outputs.claim_file(folder / name); });
  };
  const auto open = claim("open/a");
  const auto closed = claim("closed/a");
  REQUIRE(::seteuid(user) == 0);
  CHECK_FALSE(open);
  CHECK(closed == ErrorKind::output);
}

TEST_CASE("two outputs with the same path are refused, under any name of the path") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "sub");
  Outputs outputs(Existing::replace);
  outputs.claim_file(folder / "a");
  for (const char* name : {"a", "sub/../a", "./a"})
    CHECK(error_kind([&] { outputs.claim_file(folder / name); }) == ErrorKind::usage);
  CHECK(error_kind([&] { outputs.claim_folder(folder / "a/", is_marked_folder); }) ==
        ErrorKind::usage);
  outputs.file(folder / "a");
  CHECK(error_kind([&] { outputs.file(folder / "a"); }) == ErrorKind::usage);
}

TEST_CASE("an input is refused as output, by any of its names, before or after it is claimed") {
  const TemporaryFolder folder;
  write_text(folder / "gt.csv", "labels");
  fs::create_symlink("gt.csv", folder / "link.csv");
  Outputs outputs(Existing::replace);
  outputs.protect(folder / "link.csv");
  outputs.protect(folder / "none");
  CHECK(error_kind([&] { outputs.claim_file(folder / "gt.csv"); }) == ErrorKind::usage);
  fs::create_directories(folder / "db/walk");
  write_text(folder / "db/note", "old");
  outputs.protect(folder / "db/walk");
  CHECK(has(error_text(
                [&] { outputs.claim_folder(folder / "db", [](const fs::path&) { return true; }); }),
            "holds an input"));
  outputs.release(folder / "db");
  outputs.claim_folder(folder / "db", [](const fs::path&) { return true; });
  write_text(folder / "later.csv", "labels");
  outputs.claim_file(folder / "later.csv");
  CHECK(error_kind([&] { outputs.protect(folder / "later.csv"); }) == ErrorKind::usage);
}

TEST_CASE("a folder that is extended in place is replaced together with the other outputs") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "db");
  write_text(folder / "db/note", "old");
  const auto extend = [&](const std::string& text, bool somebody_is_faster) {
    Outputs outputs(Existing::refuse);
    outputs.protect(folder / "db");
    outputs.extend(folder / "db/");
    outputs.claim_file(folder / "list");
    outputs.claim_folder(folder / "db", holds_note);
    write_part(outputs.folder(folder / "db", holds_note).temporary() / "note", text);
    outputs.file(folder / "list").write(text);
    CHECK(outputs.has_outputs());
    if (somebody_is_faster) write_text(folder / "list", "another's");
    outputs.commit();
    CHECK_FALSE(outputs.has_outputs());
  };
  CHECK(error_kind([&] { extend("new", true); }) == ErrorKind::usage);
  CHECK(read_text(folder / "db/note") == "old");
  fs::remove(folder / "list");
  extend("new", false);
  CHECK(read_text(folder / "db/note") == "new");
  CHECK(list_folder(folder.path()) == Names{"db", "list"});
}

TEST_CASE("names of temporaries are unpredictable, and symbolic links are not followed") {
  const TemporaryFolder folder;
  const Output a(folder / "a", Existing::refuse);
  const Output same(folder / "a", Existing::refuse);
  CHECK(a.temporary() != same.temporary());
  CHECK(a.temporary().filename().string().size() < 60);
  write_text(folder / "victim", "mine");
  fs::create_symlink("victim", folder / "link");
  CHECK(error_kind([&] { write_part(folder / "link", "x"); }) == ErrorKind::output);
  CHECK(read_text(folder / "victim") == "mine");
}

TEST_CASE("the next run removes the temporaries of a killed process but not of a running one") {
  const TemporaryFolder folder;
  run_and_kill([&] {
    Outputs outputs(Existing::refuse);
    outputs.file(folder / "a").write("half");
    write_part(outputs.folder(folder / "plots", is_marked_folder).temporary() / "p.png", "half");
    outputs.claim_file(folder / "other");
    ::raise(SIGKILL);
  });
  CHECK(list_folder(folder.path()).size() == 3);
  Outputs living(Existing::refuse);
  living.file(folder / "a").write("mine");
  living.claim_folder(folder / "plots", is_marked_folder);
  CHECK(list_folder(folder.path()).size() == 3);  // the two new files, and the temporary of "other"
  Outputs second(Existing::refuse);
  second.claim_file(folder / "a");
  second.claim_file(folder / "other");
  CHECK(list_folder(folder.path()).size() == 4);
  living.commit();
  CHECK(read_text(folder / "a") == "mine");
}

TEST_CASE("a marked folder is replaced only if it holds nothing else") {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name) {
    Outputs outputs(Existing::replace);
    write_part(outputs.folder(folder / "plots", is_marked_folder).temporary() / name, "x");
    outputs.commit();
  };
  write("a.png");
  write("b.png");
  CHECK(list_folder(folder / "plots") == Names{".vpr-files", "b.png"});
  write_text(folder / "plots/c.png", "mine");
  CHECK(error_kind([&] { write("a.png"); }) == ErrorKind::usage);
  fs::remove(folder / "plots/c.png");
  fs::remove(folder / "plots/b.png");
  fs::create_directories(folder / "plots/b.png/thesis");
  CHECK(error_kind([&] { write("a.png"); }) == ErrorKind::usage);
  CHECK(fs::exists(folder / "plots/b.png/thesis"));
  fs::create_directory(folder / "frames");
  write_text(folder / "frames/0.png", "mine");
  CHECK(error_kind([&] { Output(folder / "frames", Existing::replace, is_marked_folder); }) ==
        ErrorKind::usage);
}

TEST_CASE("errors contain the name of an output, not of its temporary") {
  const TemporaryFolder folder;
  Outputs outputs(Existing::refuse);
  outputs.claim_file(folder / "main");
  const Output& plots = outputs.folder(folder / "plots", is_marked_folder);
  const std::string sentence =
      error_text([&] { write_part(plots.temporary() / "none/a.png", "x"); });
  CHECK(has(sentence, ".vpr-partial-"));
  CHECK(outputs.with_targets(sentence) ==
        (folder / "plots/none/a.png").string() + ": can't be written: No such file or directory");
}

TEST_CASE("folders that cannot be created or read are output errors") {
  const TemporaryFolder folder;
  make_part_folder(folder / "a");
  for (const char* name : {"a", "none/b"})
    CHECK(error_kind([&] { make_part_folder(folder / name); }) == ErrorKind::output);
  CHECK(error_kind([&] { entries_of(folder / "none"); }) == ErrorKind::output);
  CHECK(error_kind([&] { holds_note(folder / "none"); }) == ErrorKind::output);
  CHECK(entries_of(folder.path()).size() == 1);
}

TEST_CASE("a renamed old folder is restored, unless it was replaced") {
  const TemporaryFolder folder;
  const fs::path temporary = Output(folder / "db", Existing::refuse, holds_note).temporary();
  const fs::path aside = folder / (".vpr-old" + temporary.filename().string());
  const auto set_aside = [&](const std::string& text) {
    fs::create_directory(aside);
    write_text(aside / "note", text);
    const Output next(folder / "db", Existing::replace, holds_note);
  };
  set_aside("old");
  CHECK(read_text(folder / "db/note") == "old");
  set_aside("older");
  CHECK(read_text(folder / "db/note") == "old");
  CHECK(list_folder(folder.path()) == Names{"db"});
}
