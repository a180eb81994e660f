#include "database/archive.h"

#include <utility>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/json_schema.h"
#include "base/mapped_file.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

// The manifest's last key. Its value is the checksum of every byte before this text.
constexpr std::string_view kChecksumStart = ",\n  \"checksum\": \"";
constexpr std::string_view kChecksumEnd = "\"\n}\n";

constexpr JsonForm kManifestForm = {"", false, ErrorKind::data,
                                    "{}: the manifest is damaged: {}; train it again"};

// Whether the text ends in the checksum of the preceding bytes.
bool is_intact(std::string_view text) {
  const size_t start = text.rfind(kChecksumStart);
  if (start == std::string_view::npos) return false;
  const std::string_view content = text.substr(0, start);
  return text.substr(start) ==
         fmt::format("{}{}{}", kChecksumStart, checksum(content), kChecksumEnd);
}

}  // namespace

bool is_database_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / kManifestName, error)) return false;
  const auto json = parse_json(MappedFile(folder / kManifestName).text());
  if (!json || !json->is_object() || !json->contains("schema") || !json->contains("files"))
    return false;
  const Json& schema = (*json)["schema"];
  if (!schema.is_string() || !schema.get<std::string>().starts_with("vpr.database/")) return false;
  return holds_only_files(folder, [&](const std::string& name) {
    return name == kManifestName || name == kPathsName || (*json)["files"].contains(name);
  });
}

std::string sealed_manifest(const Json& manifest) {
  std::string text = to_text(manifest);
  text.resize(text.size() - std::string_view("\n}\n").size());
  return text + fmt::format("{}{}{}", kChecksumStart, checksum(text), kChecksumEnd);
}

void ArchiveWriter::add(const std::string& name, std::string_view start,
                        std::span<const std::byte> rest) {
  ChecksumStream sum;
  sum.add(std::as_bytes(std::span(start)));
  sum.add(rest);
  files_[name] = {start.size() + rest.size(), sum.text()};
  if (folder_ != nullptr)
    write_part(folder_->temporary() / name, {std::as_bytes(std::span(start)), rest});
}

Json with_files(Json schema) {
  SchemaVisitor visit{SchemaForm::data, std::move(schema)};
  visit("files", std::map<std::string, ArchiveFile>(), "The other files of the folder, by name.");
  visit("checksum", std::string(), "Checksum of the text before this key.", kIsChecksum);
  return visit.object;
}

std::string ArchiveWriter::finish(Json manifest) {
  manifest["files"] = value_to_json(files_, kDataForm);
  const std::string text = sealed_manifest(manifest);
  if (folder_ != nullptr) write_part(folder_->temporary() / kManifestName, text);
  return parse_json(text)->at("checksum").get<std::string>();
}

Archive::Archive(fs::path path) : path_(std::move(path)), source_{path_.string(), kManifestForm} {
  std::error_code error;
  if (!fs::exists(path_, error) && !error)
    throw Error(ErrorKind::input, "{}: no such database", path_.string());
  const fs::path file_name = path_ / kManifestName;
  const bool has_manifest = fs::exists(file_name, error);
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
    throw Error(ErrorKind::input, "{}: can't be read: {}", path_.string(), error.message());
  if (!has_manifest)
    throw Error(ErrorKind::data, "{}: is not a database (a folder with {}, written by vpr-train)",
                path_.string(), kManifestName);
  const std::string file = read_whole_file(file_name);
  const auto json = parse_json(file);
  if (!json) fail("it is not valid JSON");
  require_schema(*json, "database", file_name.string(), ErrorKind::data);
  if (!is_intact(file)) fail("its checksum does not match its text");
  manifest_ = *json;
}

std::string Archive::fingerprint() const { return fields(manifest_).text("checksum"); }

void Archive::verify(const std::string& name, std::span<const std::byte> bytes) const {
  const auto files = manifest_.find("files");
  if (files == manifest_.end() || !files->contains(name))
    fail(fmt::format("it does not list {}", name));
  const Fields entry = fields((*files)[name]);
  const size_t size = entry.count("bytes", std::numeric_limits<size_t>::max());
  if (bytes.size() != size)
    throw Error(
        ErrorKind::data,
        "{}/{}: expected {} bytes, found {}; the file is truncated or damaged, train it again",
        path_.string(), name, size, bytes.size());
  if (checksum(bytes) != entry.text("checksum"))
    throw Error(
        ErrorKind::data,
        "{}/{}: its checksum differs from the manifest; the file is damaged, train it again",
        path_.string(), name);
}

NpyArray Archive::array(const std::string& name) const {
  NpyArray array(path_ / name);
  verify(name, array.file_bytes());
  return array;
}

std::string Archive::text(const std::string& name) const {
  const MappedFile file(path_ / name);
  verify(name, file.bytes());
  return std::string(file.text());
}

std::string_view family_text(DatabaseFamily family) {
  return family == DatabaseFamily::fabmap ? "FAB-MAP database" : "database of sequences";
}

DatabaseFamily database_family(const std::filesystem::path& path) {
  const Archive archive(path);
  const std::string name = archive.fields(archive.manifest()).text("method");
  if (const auto family = enum_value<DatabaseFamily>(name)) return *family;
  throw Error(ErrorKind::data, "{} is a database for {}, which is unknown", archive.name(), name);
}

void require_family(const Archive& archive, DatabaseFamily family) {
  const std::string name = archive.fields(archive.manifest()).text("method");
  if (name == enum_name(family)) return;
  throw Error(ErrorKind::data, "{} is a {}. Train a {} with vpr-train {}", archive.name(),
              family_text(name == enum_name(DatabaseFamily::fabmap) ? DatabaseFamily::fabmap
                                                                    : DatabaseFamily::sequences),
              family_text(family), family == DatabaseFamily::fabmap ? "fabmap" : "images");
}

}  // namespace vpr
