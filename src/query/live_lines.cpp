#include "query/live_lines.h"

#include "base/error.h"
#include "base/json_schema.h"
#include "query/plan.h"
#include "query/train_sequences.h"

namespace vpr {
namespace {

struct LiveMatch {
  std::string sequence;
  size_t frame = 0;
  double score = 0;
  int64_t sum = 0;
};
VPR_FIELDS(LiveMatch, (sequence, "Name of the training sequence."),
           (frame, "Training frame that the query frame matches: the last one of its window."),
           (score, "Score per frame; small is good."),
           (sum, "Score of the window, as in best_scores."))

struct LiveRecognition {
  LiveMatch match;
  size_t query = 0;
};

template <class Visitor>
void visit_fields(LiveRecognition& recognition, Visitor&& visit) {
  visit_fields(recognition.match, visit);
  visit("query", recognition.query, "Recognized query frame.");
}

struct LiveLine {
  LineFrame frame;
  std::optional<LiveMatch> match;
  std::optional<double> margin, rate;
  std::vector<LiveRecognition> recognized;
};

template <class Visitor>
void visit_fields(LiveLine& line, Visitor&& visit) {
  visit("schema", Derived{schema_name("live")});
  visit("frame", line.frame.number, "Query frame, from 0.");
  visit("name", line.frame.name, "File name of the frame, or #12 of a video.");
  visit("readable", line.frame.is_readable, "Whether the frame could be decoded.");
  visit("match", line.match,
        "The best match of the window that ends with the frame; null where the readable frames up "
        "to it do not fill one.");
  visit("margin", line.margin, "Margin, in score per frame.");
  visit("rate", line.rate, "Training frames per query frame; null unless the method is filter.");
  visit("recognized", line.recognized,
        "Recognitions that this frame decides: of the window that ends with it, or, with method "
        "filter, of earlier frames, each once. At the end, one more line has those that the end of "
        "the query decides.");
}

LiveMatch live_match(const Result& result, const Match& match) {
  const size_t length = result.window_length();
  return {result.sequences[match.sequence].sequence.name, anchor_of(match.train, length),
          result.score().frame_value(match.score, length), static_cast<int64_t>(match.score)};
}

}  // namespace

Json live_line(const LineFrame& frame, const Result& shape,
               const std::optional<LiveAnswer>& answer) {
  LiveLine line{frame, {}, {}, {}, {}};
  if (answer) {
    if (answer->best) line.match = live_match(shape, *answer->best);
    line.margin = answer->margin;
    line.rate = answer->rate;
    for (const Match& match : answer->recognized)
      line.recognized.push_back(
          {live_match(shape, match), anchor_of(match.query, shape.window_length())});
  }
  return value_to_json(line, kDataForm);
}

Json live_schema() { return schema_of<LiveLine>(); }

LiveLines::LiveLines(const SequenceDatabase& database, const std::string& query_name,
                     const SequenceQuerySettings& settings, const QueryResources& resources,
                     const Monitor& monitor)
    : database_(database),
      skip_unreadable_(settings.skip_unreadable),
      choose_(tested_frames(database, settings.rule)),
      query_(database, query_name, settings, resources, monitor) {}

std::optional<LiveAnswer> LiveLines::take(const LiveFrame& frame, const Monitor& monitor) {
  std::optional<DescriptorSet> described;
  try {
    if (frame.is_unreadable)
      throw Error(ErrorKind::input, "{}: frame {} cannot be decoded", frame.file.string(),
                  frame.name);
    if (!frame.is_missing())
      described = describe_frames(frame.sequence(), database_, false, monitor, choose_);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    if (frame.is_gone()) {
      warn(monitor, "{}: does not exist, and is omitted", frame.file.string());
      return std::nullopt;
    }
    if (!skip_unreadable_) throw;
    warn(monitor, error.what());
  }
  if (described) check_descriptors(database_.descriptors, described->descriptors);
  const std::vector<uint8_t> zeros(database_.descriptors.shape().row_bytes());
  ArrivedFrame arrived{described ? described->rows()[0] : zeros, described.has_value()};
  if (described) arrived.features = described->features.all;
  last_ = {frames_++, frame.name, arrived.is_readable};
  return query_.take(arrived);
}

}  // namespace vpr
