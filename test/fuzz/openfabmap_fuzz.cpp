// Any bytes as each of OpenFABMAP's files, plain and compressed.
#include "database/openfabmap.h"
#include "fuzz.h"

using namespace vpr;

void fuzz::run(std::string_view input) {
  for (const char* name : {"f.yml", "f.yml.gz"}) {
    const std::filesystem::path path = folder_of({{name, std::string(input)}}) / name;
    refuses([&] { read_openfabmap_vocabulary(path); });
    refuses([&] { read_openfabmap_tree(path); });
    refuses([&] { read_openfabmap_frames({path, {}}, 3); });
  }
}
