// Any bytes as a database's manifest.
#include <cstdlib>
#include <fstream>

#include "base/error.h"
#include "database/fabmap_database.h"
#include "database/sequence_database.h"

namespace {

std::filesystem::path folder() {
  std::string name = "/tmp/vpr-fuzz-XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) std::abort();
  return name;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::filesystem::path kFolder = folder();
  std::ofstream(kFolder / "manifest.json", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    vpr::read_sequence_database(kFolder);
  } catch (const vpr::Error&) {
  }
  try {
    vpr::read_fabmap_database(kFolder);
  } catch (const vpr::Error&) {
  }
  return 0;
}
