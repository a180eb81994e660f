// Pages that ask a person whether images show the same place.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "present/evaluation_page.h"
#include "present/html_page.h"
#include "present/report_tables.h"

namespace vpr {
namespace {

// The files of src/present/html as string constants.
#include "html_parts.inc"

constexpr size_t kManyQuestions = 100;
constexpr int kImageSide = 640;  // pixels
constexpr int kSmallSide = 320;  // of many questions, so that a browser can open the page
constexpr size_t kMostFrames = 200;
constexpr size_t kSpreadFrames = 50;
constexpr size_t kTolerance = 5;  // frames; the page asks for another one

/// A query frame and a frame of a training sequence.
using FramePair = std::array<size_t, 2>;

/// Images of a query frame and of its match that are shown together.
struct Question {
  std::string row;  ///< of the saved file, without the answer
  std::string name = {};
  std::string about = {};
  uint32_t sequence = 0;
  std::vector<FramePair> pairs;
  std::string answer = {};
};

VPR_FIELDS(Question, row, name, about, sequence, pairs, answer)

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
Json images_of(const std::vector<Question>& questions, const GroundTruthScope& scope,
               const FrameSources& sources, const Monitor& monitor) {
  ShownFrames shown;
  shown.references.resize(scope.sequences.size());
  for (const Question& one : questions)
    for (const auto& [query_frame, train_frame] : one.pairs) {
      shown.query.insert(query_frame);
      shown.references[one.sequence].insert(train_frame);
    }
  const int side = questions.size() > kManyQuestions ? kSmallSide : kImageSide;
  const FrameImages found = read_images(shown, scope, sources, side, monitor);
  Json images = Json::object();
  const auto add = [&](const std::string& prefix, const std::map<size_t, Thumbnail>& thumbnails) {
    for (const auto& [frame, image] : thumbnails)
      images[fmt::format("{} {}", prefix, frame)] = {
          image.jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(image.jpeg), image.name};
  };
  add("query", found.query);
  for (size_t s = 0; s < found.references.size(); ++s) add(std::to_string(s), found.references[s]);
  return images;
}

/// `data`: the words of the page.
std::string page_of(Json data, const std::vector<Question>& questions, const Evaluation& evaluation,
                    const Report& report, const FrameSources& sources, const Monitor& monitor) {
  data["key"] =
      fmt::format("vpr-eval {} {}", data["noun"].get<std::string>(), evaluation.fingerprint);
  data["images"] = images_of(questions, evaluation.judgment.layout.scope, sources, monitor);
  data["questions"] = value_to_json(questions);
  return fill_page(kQuestionsPage, {{"title", html_escaped(title_with_settings(report))},
                                    {"style", palette_css() + std::string(kStyle)},
                                    {"data", script_json(data)}});
}

/// The queries to ask about, as indices of outcomes: spread evenly, then by their distance to the
/// decision.
std::vector<size_t> asked_queries(const Judgment& judgment, const GroundTruth& truth) {
  const auto& queries = judgment.outcomes.queries;
  std::vector<size_t> open;  // in the order of the path
  for (size_t q = 0; q < queries.size(); ++q)
    if (queries[q].best && (truth.asked.empty() || queries[q].verdict == Verdict::ignored))
      open.push_back(q);
  const size_t spread = std::min(kSpreadFrames, open.size());
  std::vector<size_t> asked;
  std::vector<bool> is_spread(queries.size());
  for (size_t i = 0; i < spread; ++i) {
    asked.push_back(open[(2 * i + 1) * open.size() / (2 * spread)]);
    is_spread[asked.back()] = true;
  }
  std::erase_if(open, [&](size_t q) { return is_spread[q]; });
  const auto key = [&](size_t q) {
    return confidence_key(queries[q], judgment.outcomes.confidence);
  };
  const auto unrecognized = std::stable_partition(
      open.begin(), open.end(), [&](size_t q) { return is_recognized(judgment, queries[q]); });
  std::stable_sort(open.begin(), unrecognized, [&](size_t a, size_t b) { return key(a) > key(b); });
  std::stable_sort(unrecognized, open.end(), [&](size_t a, size_t b) { return key(a) < key(b); });
  open.resize(std::min(open.size(), kMostFrames - spread));
  asked.insert(asked.end(), open.begin(), open.end());
  return asked;
}

}  // namespace

std::string place_questions_page(const Evaluation& evaluation, const Report& report,
                                 const FrameSources& sources, const Monitor& monitor) {
  const EvaluatedResult& judged = *evaluation.result;
  const Result& result = *judged.result;
  require_places(result);
  const std::vector<std::vector<FramePair>> pairs = pairs_of(result);
  std::vector<Question> questions;
  for (size_t place = 0; place < pairs.size(); ++place) {
    const Cluster& cluster = result.clusters->all[place];
    const PlaceLabel label = judged.clusters[place].label;
    Question& one = questions.emplace_back(
        Question{answer_row(result, place), result.sequences[cluster.sequence].sequence.name,
                 counted(cluster.recognitions, "recognition"), cluster.sequence, pairs[place]});
    if (report.frames.by == JudgedBy::places && label != PlaceLabel::ignore)
      one.answer = label == PlaceLabel::same ? "yes" : "no";
  }
  const Json words = {{"noun", "place"},
                      {"file", "places.csv"},
                      {"columns", kAnswerColumns},
                      {"words", {{"yes", "yes"}, {"no", "no"}}},
                      {"note", "The middle pair decides, the ends show how far the place extends."},
                      {"next", "vpr-eval RESULT --places places.csv"}};
  return page_of(words, questions, evaluation, report, sources, monitor);
}

std::string frame_questions_page(const Evaluation& evaluation, const Report& report,
                                 const FrameSources& sources, const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const GroundTruthScope& scope = judgment.layout.scope;
  if (report.has_places())
    throw Error(ErrorKind::usage,
                "--ask-frames is for results of frames, and the places of FAB-MAP have no images. "
                "Use --ground-truth");
  const bool is_one = scope.sequences.size() == 1;
  std::vector<Question> questions;
  for (const size_t q : asked_queries(judgment, evaluation.truth)) {
    const size_t query = judgment.outcomes.queries[q].frame;
    const auto [s, reference] = *judgment.outcomes.queries[q].best;
    const Sequence& train = scope.sequences[s].sequence;
    questions.push_back({fmt::format("{},{}{}", scope.query.selection.source_of(query),
                                     is_one ? "" : csv_field(train.name) + ",",
                                     train.selection.source_of(reference)),
                         train.name,
                         "",
                         s,
                         {{query, reference}}});
  }
  const size_t frames = judgment.outcomes.queries.size();
  const Json words = {
      {"noun", "frame"},
      {"file", "labels.csv"},
      {"columns", fmt::format("query,{}reference,label,tolerance", is_one ? "" : "sequence,")},
      {"words", {{"yes", "same"}, {"no", "different"}}},
      {"tolerance", std::max<size_t>(kTolerance, evaluation.truth.tolerance_frames)},
      {"note",
       fmt::format("{} of {} are asked{}.", questions.size(), counted(frames, "frame"),
                   questions.size() == kMostFrames ? ", so that the page stays small" : "")},
      {"next", "vpr-eval ANY_RESULT --ground-truth labels.csv"}};
  return page_of(words, questions, evaluation, report, sources, monitor);
}

}  // namespace vpr
