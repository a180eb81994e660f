// The main of every test program: exit code 77 tells CTest that a test lacked its data. Every test
// case starts in an empty folder of its own, so that the names of its files need no folder.
#define CATCH_CONFIG_RUNNER
#include <filesystem>
#include <optional>

#include <catch2/catch.hpp>

#include "support.h"

namespace {

class OwnFolder : public Catch::TestEventListenerBase {
 public:
  using Catch::TestEventListenerBase::TestEventListenerBase;
  void testCaseStarting(const Catch::TestCaseInfo&) override {
    folder_.emplace();
    std::filesystem::current_path(folder_->path());
  }
  void testCaseEnded(const Catch::TestCaseStats&) override {
    std::filesystem::current_path("/");
    folder_.reset();
  }

 private:
  std::optional<vpr::test::TemporaryFolder> folder_;
};
CATCH_REGISTER_LISTENER(OwnFolder)

}  // namespace

int main(int argc, char** argv) {
  const int failed = Catch::Session().run(argc, argv);
  if (failed != 0) return failed;
  return vpr::test::lacked_data() ? 77 : 0;
}
