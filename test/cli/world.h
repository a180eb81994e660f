// Command lines, and one rendered building with its databases, shared by all tests of the programs.
#pragma once

#include <filesystem>
#include <string>

#include "printed.h"
#include "support.h"

namespace vpr::test {

/// The walks of building.h: "one", "two" and "other" for training, "back" and "again" as queries.
class World {
 public:
  World();

  const TemporaryFolder& folder() const { return folder_; }
  /// The frames of a walk.
  std::string walk(const std::string& name) const { return folder_ / "walk" / name; }
  std::string truth(const std::string& name) const;
  /// Trained with "one" and "two", queried with "back".
  std::string dataset() const { return folder_ / "walk/two_walks.json"; }
  /// The database of this data set, c_l 10.
  std::string database() const { return folder_ / "w.vprdb"; }
  /// FAB-MAP's database: 60 SIFT words of "other", each frame of "one" is a place.
  std::string fabmap() const { return folder_ / "f.vprdb"; }

 private:
  TemporaryFolder folder_;
};

const World& world();

/// Copies to the folder of the test case what `make` writes. `make` runs once, in a folder of its
/// own.
void start_with(void (*make)());

/// Writes `count` images with random content, NAME/00.png and so on.
void write_walk(const std::string& name, size_t count, uint64_t seed, int width = 40,
                int height = 30);

/// The names of the images of a walk, in order.
Words images_of(const std::filesystem::path& walk);

Words lines_of(const std::string& text);

/// The words of a command line; 'several words' are one. In each word, $db, $fabmap, $dataset,
/// $walk (the folder of all walks), $one, $two, $other, $back and $again are the paths of the
/// world, and $truth is the ground truth of "back".
Words words_of(const std::string& command);

/// Runs a command line, such as "vpr-query $db --query $back", without a shell. `environment`:
/// NAME=VALUE.
RunOutcome run(const std::string& command, const std::string& environment = "");
RunOutcome run_ok(const std::string& command, const std::string& environment = "");
Json printed_json(const std::string& command);

/// The parts that are equal in two runs: without machine and timing.
Json comparable(Json json);

/// Requires at most `most_lines` lines of 80 columns, except lines that are a single word.
void check_screen(const std::string& text, size_t most_lines = 12);

/// Requires `exit_code` and one sentence on standard error that contains `word`. Command lines must
/// print nothing on standard output.
void check_failure(const RunOutcome& outcome, int exit_code, const std::string& word);
void check_failure(const std::string& command, int exit_code, const std::string& word);

}  // namespace vpr::test
