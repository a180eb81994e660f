// One rendered building with its databases, shared by all tests of the programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

/// The names of the images of a walk, in order.
Words images_of(const std::filesystem::path& walk);

Words lines_of(const std::string& text);

/// Requires `exit_code` and one sentence on standard error that contains `word`.
void check_failure(const RunOutcome& outcome, int exit_code, const std::string& word);
void check_failure(const std::string& program, const Words& arguments, int exit_code,
                   const std::string& word);

}  // namespace vpr::test
