#include "database/family.h"

#include <fmt/format.h>

#include "base/error.h"
#include "database/archive.h"

namespace vpr {
namespace {

std::string method_name(const Archive& archive) {
  return manifest_text(archive, archive.manifest(), "method");
}

}  // namespace

DatabaseFamily database_family(const std::filesystem::path& path) {
  const Archive archive(path);
  const std::string name = method_name(archive);
  if (const auto family = enum_value<DatabaseFamily>(name)) return *family;
  throw Error(ErrorKind::data,
              fmt::format("{}: is a database for {}, which is not known", archive.name(), name));
}

void require_family(const Archive& archive, DatabaseFamily family) {
  const std::string name = method_name(archive);
  const std::string_view needed = enum_name(family);
  if (name != needed)
    throw Error(ErrorKind::data, fmt::format("{}: is a database for {}, but one for {} is needed; "
                                             "train it with vpr-train {}",
                                             archive.name(), name, needed, needed));
}

}  // namespace vpr
