#include "report/explanation_report.h"

#include <fmt/format.h>

#include "base/json.h"
#include "report/table.h"

namespace vpr {
namespace {

Json evidence_json(const std::vector<WordEvidence>& words) {
  Json list = Json::array();
  for (const WordEvidence& word : words)
    list.push_back({{"word", word.word},
                    {"in_frame", word.in_frame},
                    {"in_view", word.in_view},
                    {"log_odds", word.log_odds}});
  return list;
}

void add_rows(Table& table, const std::string& side, const std::vector<WordEvidence>& words) {
  const auto yes_no = [](bool yes) { return std::string(yes ? "yes" : "no"); };
  for (const WordEvidence& word : words)
    table.rows.push_back({side, std::to_string(word.word), yes_no(word.in_frame),
                          yes_no(word.in_view), fmt::format("{:+.3f}", word.log_odds)});
}

std::string place_title(const PlaceExplanation& place) {
  return fmt::format("{} (view {}), probability {:.4f}, log-odds {:+.2f}", place.place, place.view,
                     place.match.score, place.log_odds);
}

}  // namespace

std::string explanation_text(const Explanation& explanation) {
  std::string text = fmt::format("Frame {}: new place with probability {:.4f}\n", explanation.frame,
                                 explanation.new_place);
  if (explanation.places.empty()) text += "There is no place to explain.\n";
  for (const PlaceExplanation& place : explanation.places) {
    Table table;
    table.title = place_title(place);
    table.columns = {"speaks", "word", "in the frame", "in the view", "log-odds"};
    add_rows(table, "for", place.for_it);
    add_rows(table, "against", place.against);
    text += "\n" + render_table(table, TableFormat::text);
  }
  return text;
}

Json explanation_json(const Explanation& explanation) {
  Json json = {{"frame", explanation.frame}, {"new_place", explanation.new_place}};
  json["places"] = Json::array();
  for (const PlaceExplanation& place : explanation.places)
    json["places"].push_back({{"place", place.place},
                              {"view", place.view},
                              {"probability", place.match.score},
                              {"log_odds", place.log_odds},
                              {"for", evidence_json(place.for_it)},
                              {"against", evidence_json(place.against)}});
  return json;
}

MarkedImage mark_words(const FrameFeatures& features, const PlaceExplanation& place,
                       const std::string& title) {
  MarkedImage image{features.grey, {}, title};
  const auto add = [&](const std::vector<WordEvidence>& words, bool speaks_for) {
    for (const WordEvidence& word : words)
      for (size_t i = 0; i < features.words.size(); ++i)
        if (features.words[i] == word.word)
          image.points.push_back({features.points[i], word.word, speaks_for});
  };
  add(place.against, false);
  add(place.for_it, true);
  return image;
}

}  // namespace vpr
