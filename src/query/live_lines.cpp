#include "query/live_lines.h"

#include "base/error.h"
#include "query/plan.h"
#include "query/train_sequences.h"

namespace vpr {
namespace {

Json match_json(const Result& result, const Match& match) {
  const size_t length = result.window_length();
  return {{"sequence", result.sequences[match.sequence].sequence.name},
          {"frame", anchor_of(match.train, length)},
          {"score", result.score().frame_value(match.score, length)},
          {"sum", static_cast<int64_t>(match.score)}};
}

}  // namespace

Json live_line(const LineFrame& frame, const Result& shape,
               const std::optional<LiveAnswer>& answer) {
  Json line = {{"schema", schema_name("live")},
               {"frame", frame.number},
               {"name", frame.name},
               {"readable", frame.is_readable},
               {"match", nullptr},
               {"margin", nullptr},
               {"rate", nullptr},
               {"recognized", Json::array()}};
  if (!answer) return line;
  if (answer->best) line["match"] = match_json(shape, *answer->best);
  if (answer->margin) line["margin"] = *answer->margin;
  line["rate"] = or_null(answer->rate);
  for (const Match& match : answer->recognized) {
    Json recognized = match_json(shape, match);
    recognized["query"] = anchor_of(match.query, shape.window_length());
    line["recognized"].push_back(std::move(recognized));
  }
  return line;
}

LiveLines::LiveLines(const SequenceDatabase& database, const std::string& query_name,
                     const SequenceQuerySettings& settings, const QueryResources& resources,
                     const Monitor& monitor)
    : database_(database),
      skip_unreadable_(settings.skip_unreadable),
      query_(database, query_name, settings, resources, monitor) {}

std::optional<LiveAnswer> LiveLines::take(const LiveFrame& frame, const Monitor& monitor) {
  std::optional<DescriptorSet> described;
  try {
    if (frame.is_unreadable)
      throw Error(ErrorKind::input, "{}: frame {} cannot be decoded", frame.file.string(),
                  frame.name);
    if (!frame.is_missing())
      described = describe_frames(frame.sequence(), database_, false, monitor);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    if (std::error_code ignored;
        frame.may_be_gone && !std::filesystem::exists(frame.file, ignored)) {
      warn(monitor, "{}: does not exist, and is omitted", frame.file.string());
      return std::nullopt;
    }
    if (!skip_unreadable_) throw;
    warn(monitor, error.what());
  }
  if (described) check_descriptors(database_.descriptors, described->descriptors);
  const std::vector<uint8_t> zeros(database_.descriptors.shape().row_bytes());
  ArrivedFrame arrived{described ? described->rows()[0] : zeros, described.has_value()};
  last_ = {frames_++, frame.name, arrived.is_readable};
  return query_.take(arrived);
}

}  // namespace vpr
