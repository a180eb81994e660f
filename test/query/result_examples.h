// Results for tests of their files.
#pragma once

#include "base/json.h"
#include "query/result_file.h"
#include "support.h"

namespace vpr::test {

inline Result example_result() {
  Result result;
  result.settings = SequenceQuerySettings{Threshold{{.window_length = 2}, 0.4}};
  result.query.name = "walk";
  result.query.frames = 5;
  result.query.unreadable = {4};
  result.query_windows = 4;
  result.sequences = {{{"a", 6}, 5, true, 0.4, ThresholdScale::relative, 12, 30},
                      {{"b", 3}, 2, false, {}, ThresholdScale::bits, 0, {}}};
  result.recognitions = {{0, 0, 1, 0, 11}, {1, 0, 2, 0, 9}};
  result.best = {Match{0, 0, 1, 0, 11}, Match{1, 0, 2, 0, 9}, Match{2, 0, 0, 0, 20}, std::nullopt};
  result.clusters = {{{0, 1, 0, 1, 2, 1, 2, 2, 9}}, {0, 0}};
  return result;
}

/// Two places with three views; five frames, one without words and one unreadable.
inline Result places_example() {
  Result result;
  result.settings = FabmapQuerySettings{};
  result.query.name = "walk";
  result.query.frames = result.query_windows = 5;
  result.query.unreadable = {4};
  result.sequences = {{{"places", 2}, 2, true, {}, ThresholdScale::bits, 0, {}}};
  result.places = ResultPlaces{{"hall", "stairs"}, 3, 1, {0.1, 0.2, 0.3, 0.9, 0}};
  result.recognitions = {{0, 0, 0, 1, 0.995}, {0, 0, 1, 2, 0.991}, {2, 0, 1, 2, 0.999}};
  result.best = {result.recognitions[0], Match{1, 0, 0, 0, 0.25}, result.recognitions[2],
                 std::nullopt, std::nullopt};
  return result;
}

inline Json write(const std::filesystem::path& path, const Result& result, Existing existing) {
  Outputs outputs(existing);
  Json json = write_result(path, result, {}, outputs);
  outputs.commit();
  return json;
}

inline std::filesystem::path write_example(Existing existing = Existing::refuse) {
  write("r.json", example_result(), existing);
  return "r.json";
}

}  // namespace vpr::test
