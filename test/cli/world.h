// One rendered building with its databases, made once for all tests of the programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/json.h"
#include "support.h"

namespace vpr::test {

/// The walks of building.h: "one", "two" and "other" trained, "back" and "again" queries.
class World {
 public:
  World();

  const TemporaryFolder& folder() const { return folder_; }
  /// The frames of a walk.
  std::string walk(const std::string& name) const { return folder_ / "walk" / name; }
  std::string truth(const std::string& name) const;
  /// Trained with "one" and "two", queried with "back".
  std::string dataset() const { return folder_ / "walk/two_walks.json"; }
  /// Of that data set, c_l 10.
  std::string database() const { return folder_ / "w.vprdb"; }
  /// FAB-MAP's: 60 SIFT words of "other", each frame of "one" a place.
  std::string fabmap() const { return folder_ / "f.vprdb"; }

 private:
  TemporaryFolder folder_;
};

const World& world();

/// What a program printed as JSON; it must have ended with 0.
Json printed_json(const RunOutcome& outcome);

/// A program that ended with `exit_code` and one sentence on standard error, and in it `word`.
void check_failure(const RunOutcome& outcome, int exit_code, const std::string& word);

}  // namespace vpr::test
