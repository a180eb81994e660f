// The files of a database of either family, with valid checksums added, and a small query if it can
// be opened.
#include "base/checksum.h"
#include "base/json.h"
#include "database/archive.h"
#include "fabmap/place_query.h"
#include "fuzz.h"
#include "query/prepare.h"
#include "query/run_query.h"

using namespace vpr;

namespace {

constexpr size_t kQueryFrames = 4;

// Lists the existing files in the manifest, and adds its checksum.
void seal(std::vector<fuzz::Part>& parts) {
  for (fuzz::Part& part : parts) {
    std::optional<Json> manifest = parse_json(part.bytes);
    if (part.name != kManifestName || !manifest || !manifest->is_object()) continue;
    manifest->erase("checksum");
    Json& files = (*manifest)["files"] = Json::object();
    for (const fuzz::Part& file : parts)
      if (file.name != kManifestName)
        files[file.name] = {{"bytes", file.bytes.size()},
                            {"checksum", checksum(std::string_view(file.bytes))}};
    part.bytes = sealed_manifest(*manifest);
  }
}

void query_sequences(const std::filesystem::path& folder) {
  SequenceDatabase database = read_sequence_database(folder);
  const DescriptorRows rows = database.descriptors.rows();
  DescriptorSet query;
  query.descriptors.kind = database.descriptors.kind;
  query.descriptors.append(rows.first(std::min(kQueryFrames, rows.size())));
  query.sequence.frames = query.rows().size();
  QueryResources resources;
  ensure_statistics(database, {});
  for (const Score score : {Score::raw, Score::zscore}) {
    const SequenceQuerySettings settings{Threshold{{.window_length = 2, .score = score}}};
    fuzz::refuses([&] {
      run_query(
          plan_query(prepare(database, settings, resources), query, "q", settings, resources, {}),
          {}, {});
    });
  }
}

void query_places(const std::filesystem::path& folder) {
  const FabmapDatabase database = read_fabmap_database(folder);
  SequenceWords query;
  for (size_t v = 0; v < std::min(kQueryFrames, database.views.views()); ++v)
    query.words.emplace_back(database.views.view(v).begin(), database.views.view(v).end());
  query.sequence.frames = query.words.size();
  query_fabmap(database, query, "q", {}, 1, [](size_t, std::span<const double>) {}, {});
}

}  // namespace

void fuzz::run(std::string_view input) {
  std::vector<Part> parts = split_parts(input);
  seal(parts);
  const std::filesystem::path folder = folder_of(parts);
  refuses([&] { query_sequences(folder); });
  refuses([&] { query_places(folder); });
}
