#include "truth/places.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/rows.h"
#include "base/text.h"
#include "truth/readers.h"

namespace vpr {

std::vector<MarkedPlace> read_marked_places(const std::filesystem::path& path) {
  Rows rows(path, path.string(), {{"sequence", "train", "query", "tolerance"}, 4});
  if (rows.size() == 0)
    rows.fail("has no places. Mark some on the page of vpr-eval --ask-fabmap and save it again");
  std::vector<MarkedPlace> places;
  while (rows.next()) {
    const std::string_view sequence = rows.text("sequence");
    if (sequence.empty()) rows.fail("the sequence is empty. Name it");
    const size_t frame = rows.frame("train", kMaxGrownFrames);
    auto place = std::ranges::find_if(places, [&](const MarkedPlace& one) {
      return one.sequence == sequence && one.frame == frame;
    });
    if (place == places.end())
      place = places.insert(place, {.sequence = std::string(sequence), .frame = frame});
    if (rows.text("query").empty()) continue;
    place->visits.push_back({rows.frame("query", kMaxGrownFrames),
                             rows.frame("tolerance", kMaxGrownFrames), rows.line()});
  }
  return places;
}

std::string read_places(GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  if (builder.query().grows)
    throw Error(ErrorKind::usage,
                "{}: places need the number of query frames. Pass --result, a result of FAB-MAP",
                path.string());
  const std::vector<MarkedPlace> places = read_marked_places(path);
  const size_t sequence = builder.only_searched(path.string());
  builder.require_train_frames(sequence, places.size());
  const size_t query_frames = builder.query().frames;
  size_t passed = 0;
  for (size_t p = 0; p < places.size(); ++p) {
    std::map<size_t, PlaceLabel> labels;  // by query frame
    for (const auto& [query, tolerance, line] : places[p].visits) {
      builder.at("line", line);
      if (query >= query_frames) {
        builder.report_out_of_range("query", std::to_string(query), builder.query());
        continue;
      }
      const size_t first = query - std::min(query, 2 * tolerance);
      const size_t last = std::min(query + 2 * tolerance, query_frames - 1);
      for (size_t q = first; q <= last; ++q) {
        const bool is_same = q + tolerance >= query && q <= query + tolerance;
        PlaceLabel& label = labels.try_emplace(q, PlaceLabel::ignore).first->second;
        if (is_same) label = PlaceLabel::same;
      }
    }
    for (const auto& [query, label] : labels) builder.add(query, sequence, p, p, label);
    passed += labels.empty() ? 0 : 1;
  }
  return fmt::format(
      "{} that a person marked, {} of them on the path; as many frames again before and after a "
      "place are ignored",
      counted(places.size(), "place"), passed);
}

}  // namespace vpr
