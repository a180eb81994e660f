// A result of vpr-query, of any method, with the schema of this version and valid checksums; and
// the report of readable ones.
#include <fmt/format.h>

#include "base/checksum.h"
#include "base/json.h"
#include "base/npy.h"
#include "evaluate/report.h"
#include "fuzz.h"
#include "query/result_file.h"

using namespace vpr;

namespace {

constexpr size_t kMaxFrames = 1000;  // limit for the time of a report

// Packs the arrays, r.NAME.npy, as r.npz, and completes r.json.
void seal(std::vector<fuzz::Part>& parts) {
  std::vector<fuzz::Part> arrays;
  Json entries = Json::object();
  for (const fuzz::Part& part : parts) {
    if (!part.name.starts_with("r.") || !part.name.ends_with(".npy")) continue;
    const auto header = parse_npy_header(part.bytes);
    const std::string name = part.name.substr(2);
    entries[name.substr(0, name.size() - 4)] = {
        {"rows", header && !header->shape.empty() ? header->shape[0] : 0},
        {"checksum", checksum(std::string_view(part.bytes))}};
    arrays.push_back({name, part.bytes});
  }
  if (!arrays.empty() && fuzz::find_part(parts, "r.npz") == nullptr)
    parts.push_back({"r.npz", fuzz::packed(arrays)});
  for (fuzz::Part& part : parts) {
    std::optional<Json> json = parse_json(part.bytes);
    if (part.name != "r.json" || !json || !json->is_object()) continue;
    if (json->contains("schema")) (*json)["schema"] = schema_name("result");
    Json& files = (*json)["files"];
    if (!files.is_object()) files = Json::object();
    files.update(entries);
    (*json)["checksum"] = result_checksum(*json);
    part.bytes = to_text(*json);
  }
}

void report(const Result& result) {
  size_t frames = result.query.frames;
  for (const auto& sequence : result.sequences) frames += sequence.sequence.frames;
  if (frames > kMaxFrames) return;
  std::string poses = "frame,x,y\n";
  for (size_t frame = 0; frame < result.query.frames; ++frame)
    poses += fmt::format("{},{},0\n", frame, frame);
  const EvaluationSettings by{GroundTruthArgument{"aligned", {}, 1}, fuzz::memory_file(poses), {}};
  report_json(report_of(evaluate_result(std::make_shared<const Result>(result), {}, by, {}), {}));
}

}  // namespace

void fuzz::run(std::string_view input) {
  std::vector<Part> parts = split_parts(input);
  seal(parts);
  const std::filesystem::path path = folder_of(parts) / "r.json";
  refuses([&] { report(read_result(path).result); });
}
