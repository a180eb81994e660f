#include "present/questions_page.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/place_answers.h"
#include "present/html_page.h"
#include "present/report_tables.h"

namespace vpr {
namespace {

// The files of src/present/html as string constants.
#include "html_parts.inc"

constexpr size_t kManyPlaces = 100;
constexpr int kImageSide = 640;  // pixels
constexpr int kSmallSide = 320;  // of many places, so that a browser can open the page

/// A query frame and a frame of a training sequence.
using FramePair = std::array<size_t, 2>;

/// Per place: the first recognition, the representative and the last recognition; equal ones once.
std::vector<std::vector<FramePair>> pairs_of(const Result& result) {
  const size_t length = result.window_length();
  std::vector<std::vector<FramePair>> pairs(result.clusters->all.size());
  std::vector<FramePair> last(pairs.size());
  const auto add = [&](size_t place, const FramePair& pair) {
    if (std::ranges::find(pairs[place], pair) == pairs[place].end()) pairs[place].push_back(pair);
  };
  for (size_t r = 0; r < result.recognitions.size(); ++r) {
    const Match& match = result.recognitions[r];
    const size_t place = result.clusters->of_recognition[r];
    last[place] = {anchor_of(match.query, length), anchor_of(match.train, length)};
    if (pairs[place].empty()) pairs[place].push_back(last[place]);
  }
  for (size_t place = 0; place < pairs.size(); ++place) {
    const Cluster& cluster = result.clusters->all[place];
    add(place, {anchor_of(cluster.query_window, length), anchor_of(cluster.train_window, length)});
    add(place, last[place]);
  }
  return pairs;
}

/// By "query frame", and "sequence frame": a data URL, empty for an unreadable frame, and a name.
void add_images(Json& images, const std::string& prefix, const SequenceSource& source,
                const Selection& selection, const std::set<size_t>& frames, int side,
                const Monitor& monitor) {
  for (const auto& [frame, image] : make_thumbnails(source, selection, frames, side, monitor))
    images[fmt::format("{} {}", prefix, frame)] = {
        image.jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(image.jpeg), image.name};
}

Json images_of(const std::vector<std::vector<FramePair>>& pairs, const Result& result,
               const FrameSources& sources, const Monitor& monitor) {
  std::set<size_t> query;
  std::vector<std::set<size_t>> train(result.sequences.size());
  for (size_t place = 0; place < pairs.size(); ++place)
    for (const auto& [query_frame, train_frame] : pairs[place]) {
      query.insert(query_frame);
      train[result.clusters->all[place].sequence].insert(train_frame);
    }
  const int side = pairs.size() > kManyPlaces ? kSmallSide : kImageSide;
  Json images = Json::object();
  add_images(images, "query", *sources.query, result.query.selection, query, side, monitor);
  for (size_t s = 0; s < train.size(); ++s)
    add_images(images, std::to_string(s), *sources.references[s],
               result.sequences[s].sequence.selection, train[s], side, monitor);
  return images;
}

}  // namespace

std::string questions_page(const Evaluation& evaluation, const Report& report,
                           const FrameSources& sources, const Monitor& monitor) {
  const EvaluatedResult& judged = *evaluation.result;
  const Result& result = judged.result;
  require_places(result);
  const std::vector<std::vector<FramePair>> pairs = pairs_of(result);
  Json data = {{"result", evaluation.fingerprint},
               {"columns", kAnswerColumns},
               {"images", images_of(pairs, result, sources, monitor)},
               {"places", Json::array()}};
  for (size_t place = 0; place < pairs.size(); ++place) {
    const Cluster& cluster = result.clusters->all[place];
    const PlaceLabel label = judged.clusters[place].label;
    Json& json =
        data["places"].emplace_back(Json{{"row", answer_row(result, place)},
                                         {"name", result.sequences[cluster.sequence].sequence.name},
                                         {"sequence", cluster.sequence},
                                         {"recognitions", cluster.recognitions},
                                         {"pairs", pairs[place]}});
    if (report.judged == JudgedBy::places && label != PlaceLabel::ignore)
      json["answer"] = label == PlaceLabel::same ? "yes" : "no";
  }
  return fill_page(kQuestionsPage, {{"title", html_escaped(title_with_settings(report))},
                                    {"style", palette_css() + std::string(kStyle)},
                                    {"data", script_json(data)}});
}

}  // namespace vpr
