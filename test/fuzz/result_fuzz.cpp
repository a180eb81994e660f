// A result of vpr-query, of any method, with its companions and valid checksums added; and the
// report of readable ones.
#include <fmt/format.h>

#include "base/checksum.h"
#include "base/json.h"
#include "evaluate/report.h"
#include "fuzz.h"
#include "query/result_file.h"

using namespace vpr;

namespace {

constexpr size_t kMaxFrames = 1000;  // limit for the time of a report

// Lists the checksums of the companions in r.json, and adds its own.
void seal(std::vector<fuzz::Part>& parts) {
  for (fuzz::Part& part : parts) {
    std::optional<Json> json = parse_json(part.bytes);
    if (part.name != "r.json" || !json || !json->is_object()) continue;
    Json& files = (*json)["files"];
    if (!files.is_object()) files = Json::object();
    for (const fuzz::Part& file : parts) {
      if (!file.name.starts_with("r.") || !file.name.ends_with(".npy")) continue;
      Json& entry = files[file.name.substr(2, file.name.size() - 6)];
      entry = {{"rows", 0}, {"checksum", checksum(std::string_view(file.bytes))}};
    }
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
