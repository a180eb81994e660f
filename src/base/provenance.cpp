#include "base/provenance.h"

namespace vpr {

std::string program_version() { return VPR_VERSION; }

std::string program_commit() {
  return
#include "commit.inc"
      ;
}

}  // namespace vpr
