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
  Outputs outputs(Existing::refuse);
  outputs.claim_file("main.json");
  outputs.claim_file("page.html");
  outputs.claim_file("never.png");
  outputs.file("page.html").write("page");
  outputs.file("main.json").write("main");
  write_part(outputs.folder("plots", is_marked_folder).temporary() / "a.png", "a");
  for (const std::string& name : list_folder(".")) CHECK(name.starts_with(".vpr-partial-"));
  outputs.commit();
  CHECK(list_folder(".") == Names{"main.json", "page.html", "plots"});
  CHECK(read_text("main.json") == "main");
  CHECK(list_folder("plots") == Names{".vpr-files", "a.png"});
}

TEST_CASE("a claimed file that a new run lacks is removed with the outputs that it replaces") {
  write_file("r.json", "old", Existing::refuse);
  write_file("r.path.npy", "old", Existing::refuse);
  {
    Outputs outputs(Existing::replace);
    outputs.claim_file("r.json");
    outputs.claim_file("r.path.npy");
    outputs.commit();  // without any output
    CHECK(list_folder(".") == Names{"r.json", "r.path.npy"});
  }
  Outputs outputs(Existing::replace);
  outputs.claim_file("r.json");
  outputs.claim_file("r.path.npy");
  outputs.file("r.json").write("new");
  CHECK(read_text("r.path.npy") == "old");
  outputs.commit();
  CHECK(list_folder(".") == Names{"r.json"});
}

TEST_CASE("without a commit, nothing changes") {
  write_text("a", "old");
  {
    Outputs outputs(Existing::replace);
    outputs.file("a").write("new");
    outputs.file("b").write("new");
  }
  CHECK(list_folder(".") == Names{"a"});
  CHECK(read_text("a") == "old");
}

TEST_CASE("an existing file is refused, both before the work and at its end") {
  Outputs late(Existing::refuse);
  late.file("a");
  write_text("a", "first");  // another program was faster
  CHECK(error_kind([&] { late.commit(); }) == ErrorKind::usage);
  CHECK(error_kind([&] { write_file("a", "x", Existing::refuse); }) == ErrorKind::usage);
  CHECK(read_text("a") == "first");
  write_file("a", "second", Existing::replace);
  CHECK(read_text("a") == "second");
}

TEST_CASE("a missing parent folder, or a folder with the name of an output file, is an error") {
  fs::create_directory("sub");
  CHECK(error_kind([&] { Output("no/a", Existing::refuse); }) == ErrorKind::output);
  CHECK(error_kind([&] { Output("sub", Existing::replace); }) == ErrorKind::usage);
}

TEST_CASE("a folder is replaced in one step, and only if it is an output of the program") {
  const auto write = [&](const std::string& text, Existing existing) {
    Outputs outputs(existing);
    write_part(outputs.folder("db", holds_note).temporary() / "note", text);
    outputs.commit();
  };
  write("one", Existing::refuse);
  CHECK(error_kind([&] { write("two", Existing::refuse); }) == ErrorKind::usage);
  write("two", Existing::replace);
  CHECK(read_text("db/note") == "two");
  CHECK(list_folder(".") == Names{"db"});
  fs::create_directory("home");
  write_text("home/letter", "dear");
  CHECK(error_kind([&] { Output("home", Existing::replace, holds_note); }) == ErrorKind::usage);
  CHECK(read_text("home/letter") == "dear");
}

TEST_CASE("a full disk is an output error") {
  if (!fs::exists("/dev/full")) return;
  Output file(fs::temp_directory_path() / "vpr-full-test", Existing::replace);
  CHECK(error_kind([&] { file.reserve(uint64_t{1} << 60); }) == ErrorKind::output);
}

TEST_CASE("a target that is not a regular file is not replaced") {
  fs::create_symlink("/dev/null", "null");
  CHECK(error_kind([&] { write_file("null", "x", Existing::replace); }) == ErrorKind::usage);
}

TEST_CASE("a target that another program creates during the run is kept") {
  {
    Outputs outputs(Existing::refuse);
    outputs.file("main").write("mine");
    outputs.file("companion").write("mine");
    write_text("main", "another's");
    CHECK(error_kind([&] { outputs.commit(); }) == ErrorKind::usage);
  }
  CHECK(list_folder(".") == Names{"main"});
  CHECK(read_text("main") == "another's");
}

TEST_CASE("two concurrent runs with the same outputs leave the outputs of one of them") {
  const Names names = {"main", "page", "plot", "list"};
  const auto run = [&](const std::string& text) {
    Outputs outputs(Existing::replace);
    for (const std::string& name : names) outputs.file(name).write(text);
    outputs.commit();
  };
  run("first");
  for (int round = 0; round < 200; ++round) {
    std::thread other([&] { run("a"); });
    run("b");
    other.join();
    const std::string main = read_text("main");
    for (const std::string& name : names) REQUIRE(read_text(name) == main);
  }
  CHECK(list_folder(".").size() == names.size());
}

TEST_CASE("an output that cannot be written is detected by claim_file") {
  Outputs outputs(Existing::refuse);
  const auto claim = [&](const std::string& name) {
    return error_kind([&] { outputs.claim_file(name); });
  };
  CHECK(claim("no/a") == ErrorKind::output);
  CHECK(claim(std::string(256, 'x')) == ErrorKind::output);
  CHECK_FALSE(claim(std::string(255, 'x')));
  outputs.file(std::string(255, 'x')).write("long");
  outputs.commit();
  CHECK(read_text(std::string(255, 'x')) == "long");
}

TEST_CASE("a foreign folder is detected when an output in it is claimed") {
  fs::permissions(".", fs::perms(0755));
  for (const auto& [name, mode] : {std::pair("open", 0777), std::pair("closed", 0555)}) {
    fs::create_directory(name);
    fs::permissions(name, fs::perms(mode));
  }
  const uid_t user = ::geteuid();
  if (user == 0) REQUIRE(::seteuid(65534) == 0);  // root may write everywhere
  const auto claim = [&](const std::string& name) {
    Outputs outputs(Existing::refuse);
    return error_kind([&] { outputs.claim_file(name); });
  };
  const auto open = claim("open/a");
  const auto closed = claim("closed/a");
  REQUIRE(::seteuid(user) == 0);
  CHECK_FALSE(open);
  CHECK(closed == ErrorKind::output);
}

TEST_CASE("two outputs with the same path are refused, under any name of the path") {
  fs::create_directory("sub");
  Outputs outputs(Existing::replace);
  outputs.claim_file("a");
  for (const char* name : {"a", "sub/../a", "./a"})
    CHECK(error_kind([&] { outputs.claim_file(name); }) == ErrorKind::usage);
  CHECK(error_kind([&] { outputs.claim_folder("a/", is_marked_folder); }) == ErrorKind::usage);
  outputs.file("a");
  CHECK(error_kind([&] { outputs.file("a"); }) == ErrorKind::usage);
}

TEST_CASE("an input is refused as output, by any of its names, before or after it is claimed") {
  write_text("gt.csv", "labels");
  fs::create_symlink("gt.csv", "link.csv");
  Outputs outputs(Existing::replace);
  outputs.protect("link.csv");
  outputs.protect("none");
  CHECK(error_kind([&] { outputs.claim_file("gt.csv"); }) == ErrorKind::usage);
  fs::create_directories("db/walk");
  write_text("db/note", "old");
  outputs.protect("db/walk");
  CHECK(has(error_text([&] { outputs.claim_folder("db", [](const fs::path&) { return true; }); }),
            "holds an input"));
  outputs.release("db");
  outputs.claim_folder("db", [](const fs::path&) { return true; });
  write_text("later.csv", "labels");
  outputs.claim_file("later.csv");
  CHECK(error_kind([&] { outputs.protect("later.csv"); }) == ErrorKind::usage);
}

TEST_CASE("a folder that is extended in place is replaced together with the other outputs") {
  fs::create_directory("db");
  write_text("db/note", "old");
  const auto extend = [&](const std::string& text, bool somebody_is_faster) {
    Outputs outputs(Existing::refuse);
    outputs.protect("db");
    outputs.extend("db/");
    outputs.claim_file("list");
    outputs.claim_folder("db", holds_note);
    write_part(outputs.folder("db", holds_note).temporary() / "note", text);
    outputs.file("list").write(text);
    CHECK(outputs.has_outputs());
    if (somebody_is_faster) write_text("list", "another's");
    outputs.commit();
    CHECK_FALSE(outputs.has_outputs());
  };
  CHECK(error_kind([&] { extend("new", true); }) == ErrorKind::usage);
  CHECK(read_text("db/note") == "old");
  fs::remove("list");
  extend("new", false);
  CHECK(read_text("db/note") == "new");
  CHECK(list_folder(".") == Names{"db", "list"});
}

TEST_CASE("names of temporaries are unpredictable, and symbolic links are not followed") {
  const Output a("a", Existing::refuse);
  const Output same("a", Existing::refuse);
  CHECK(a.temporary() != same.temporary());
  CHECK(a.temporary().filename().string().size() < 60);
  write_text("victim", "mine");
  fs::create_symlink("victim", "link");
  CHECK(error_kind([&] { write_part("link", "x"); }) == ErrorKind::output);
  CHECK(read_text("victim") == "mine");
}

TEST_CASE("the next run removes the temporaries of a killed process but not of a running one") {
  run_and_kill([&] {
    Outputs outputs(Existing::refuse);
    outputs.file("a").write("half");
    write_part(outputs.folder("plots", is_marked_folder).temporary() / "p.png", "half");
    outputs.claim_file("other");
    ::raise(SIGKILL);
  });
  CHECK(list_folder(".").size() == 3);
  Outputs living(Existing::refuse);
  living.file("a").write("mine");
  living.claim_folder("plots", is_marked_folder);
  CHECK(list_folder(".").size() == 3);  // the two new files, and the temporary of "other"
  Outputs second(Existing::refuse);
  second.claim_file("a");
  second.claim_file("other");
  CHECK(list_folder(".").size() == 4);
  living.commit();
  CHECK(read_text("a") == "mine");
}

TEST_CASE("a marked folder is replaced only if it holds nothing else") {
  const auto write = [&](const std::string& name) {
    Outputs outputs(Existing::replace);
    write_part(outputs.folder("plots", is_marked_folder).temporary() / name, "x");
    outputs.commit();
  };
  write("a.png");
  write("b.png");
  CHECK(list_folder("plots") == Names{".vpr-files", "b.png"});
  write_text("plots/c.png", "mine");
  CHECK(error_kind([&] { write("a.png"); }) == ErrorKind::usage);
  fs::remove("plots/c.png");
  fs::remove("plots/b.png");
  fs::create_directories("plots/b.png/thesis");
  CHECK(error_kind([&] { write("a.png"); }) == ErrorKind::usage);
  CHECK(fs::exists("plots/b.png/thesis"));
  fs::create_directory("frames");
  write_text("frames/0.png", "mine");
  CHECK(error_kind([&] { Output("frames", Existing::replace, is_marked_folder); }) ==
        ErrorKind::usage);
}

TEST_CASE("errors contain the name of an output, not of its temporary") {
  Outputs outputs(Existing::refuse);
  outputs.claim_file("main");
  const Output& plots = outputs.folder("plots", is_marked_folder);
  const std::string sentence =
      error_text([&] { write_part(plots.temporary() / "none/a.png", "x"); });
  CHECK(has(sentence, ".vpr-partial-"));
  CHECK(outputs.with_targets(sentence) ==
        std::string("plots/none/a.png") + ": can't be written: No such file or directory");
}

TEST_CASE("folders that cannot be created or read are output errors") {
  make_part_folder("a");
  for (const char* name : {"a", "none/b"})
    CHECK(error_kind([&] { make_part_folder(name); }) == ErrorKind::output);
  CHECK(error_kind([&] { entries_of("none"); }) == ErrorKind::output);
  CHECK(error_kind([&] { holds_note("none"); }) == ErrorKind::output);
  CHECK(entries_of(".").size() == 1);
}

TEST_CASE("a renamed old folder is restored, unless it was replaced") {
  const fs::path temporary = Output("db", Existing::refuse, holds_note).temporary();
  const fs::path aside = (".vpr-old" + temporary.filename().string());
  const auto set_aside = [&](const std::string& text) {
    fs::create_directory(aside);
    write_text(aside / "note", text);
    const Output next("db", Existing::replace, holds_note);
  };
  set_aside("old");
  CHECK(read_text("db/note") == "old");
  set_aside("older");
  CHECK(read_text("db/note") == "old");
  CHECK(list_folder(".") == Names{"db"});
}
