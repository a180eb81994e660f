#include "explain_fabmap.h"

#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "images/sequence.h"
#include "images/sequence_names.h"
#include "report/png_file.h"
#include "report/result_file.h"
#include "report/table.h"
#include "report/word_picture.h"

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

std::filesystem::path explanation_picture_path(const std::string& output) {
  return companion_path(output, "explain.png");
}

std::map<size_t, SequenceArgument> images_by_group(const QueryInputs& inputs,
                                                   const FabmapDatabase& database) {
  std::map<size_t, SequenceArgument> images;
  for (const std::string& text : inputs.train_images) {
    // A path that exists as it is wins over a group's name.
    const bool is_path = std::filesystem::exists(parse_sequence_argument(text).path);
    const size_t equals = is_path ? std::string::npos : text.find('=');
    const SequenceArgument argument =
        parse_sequence_argument(equals == std::string::npos ? text : text.substr(equals + 1));
    const std::string name =
        equals == std::string::npos ? sequence_names({argument}).front() : text.substr(0, equals);
    size_t group = 0;
    while (group < database.groups.size() &&
           (database.groups[group].name != name || images.contains(group)))
      ++group;
    if (group == database.groups.size())
      throw Error(ErrorKind::usage,
                  fmt::format("--train-images: the database has no further group named {}; "
                              "vpr-train info lists them",
                              name));
    images[group] = argument;
  }
  return images;
}

void write_explanation_picture(const Explanation& explanation, const QueryInputs& inputs,
                               const SequenceArgument& query, const FabmapDatabase& searched,
                               bool searches_query, const Session& session) {
  std::map<size_t, SequenceArgument> images = images_by_group(inputs, searched);
  if (searches_query) images[searched.groups.size() - 1] = query;
  const FrameFeatures frame =
      locate_words(open_sequence(query), explanation.frame, searched, session.monitor);
  std::vector<ImagePair> pairs;
  for (const PlaceExplanation& place : explanation.places) {
    ImagePair& pair = pairs.emplace_back();
    pair.query = mark_words(frame, place, fmt::format("query frame {}", explanation.frame));
    pair.view.title = fmt::format("{}, probability {:.4f}, log-odds {:+.2f}", place.place,
                                  place.match.score, place.log_odds);
    const ViewOrigin origin = searched.origin(place.match.view);
    const auto source = images.find(origin.group);
    if (source == images.end()) {
      pair.view.title += " (its images: --train-images)";
      continue;
    }
    try {
      const FrameFeatures view =
          locate_words(open_sequence(source->second), origin.frame, searched, session.monitor);
      pair.view = mark_words(view, place, pair.view.title);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      pair.view.title += " (can't be decoded)";
    }
  }
  session.outputs.file(explanation_picture_path(session.options.output))
      .write(png_of(draw_word_pairs(pairs)));
}

}  // namespace vpr
