#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/rows.h"
#include "base/text.h"
#include "truth/readers.h"

namespace vpr {
namespace {

/// Labels of one query frame and one training sequence: `same` with the surroundings.
using RowLabels = std::vector<LabelStretch>;

void add_label(const GroundTruthBuilder& builder, size_t query, const LabelStretch& added,
               RowLabels& labels) {
  for (const LabelStretch& run : labels)
    if (run.label != added.label && run.first <= added.last && added.first <= run.last)
      builder.fail("query {} and reference {} are labeled both same and different", query,
                   (run.label == PlaceLabel::different ? run : added).first);
  labels.push_back(added);
}

// Adds the pairs of the same place, and all pairs without a label as pairs to ignore.
void add_row(GroundTruthBuilder& builder, size_t query, size_t sequence, RowLabels labels) {
  const size_t frames = builder.train(sequence).frames;
  std::ranges::sort(labels, {}, &LabelStretch::first);
  size_t next = 0;  // after the known pairs
  for (const LabelStretch& run : labels) {
    if (run.first > next) builder.add(query, sequence, next, run.first - 1, PlaceLabel::ignore);
    const size_t first = std::max(run.first, next);
    if (run.label == PlaceLabel::same && first <= run.last)
      builder.add(query, sequence, first, run.last, run.label);
    next = std::max(next, run.last + 1);
  }
  if (next < frames) builder.add(query, sequence, next, frames - 1, PlaceLabel::ignore);
}

}  // namespace

std::string read_labels(GroundTruthBuilder& builder) {
  const std::string name = builder.argument().path.string();
  if (builder.argument().tolerance_frames != 0)
    throw Error(ErrorKind::usage, "{}: each label has its own tolerance. Omit --tolerance", name);
  if (builder.query().grows)
    throw Error(ErrorKind::usage,
                "{}: labels need the numbers of frames. Pass --result, or --query-frames and "
                "--train-frames",
                name);
  const SequenceArgument source = parse_sequence_argument(name);
  builder.set_query_range(source);
  Rows rows(source.path, name, {{"query", "reference", "label", "tolerance", "sequence"}, 4});
  if (rows.size() == 0)
    rows.fail("has no labels. Answer the page of vpr-eval --ask-frames and save it again");
  const size_t only = rows.has("sequence") ? 0 : builder.only_searched(name);
  std::map<std::pair<size_t, size_t>, RowLabels> labels;
  std::vector<std::vector<GroundTruth::Pair>> asked(builder.query().frames);
  while (rows.next()) {
    builder.at("line", rows.line());
    const size_t sequence =
        rows.has("sequence") ? builder.find_sequence(rows.text("sequence")) : only;
    const auto query = frame_in_range(source.range, rows.frame("query", kMaxGrownFrames));
    const size_t reference = rows.frame("reference", kMaxGrownFrames);
    const size_t frames = builder.train(sequence).frames;
    if (!query) continue;
    if (*query >= asked.size())
      builder.report_out_of_range("query", rows.text("query"), builder.query());
    if (reference >= frames)
      builder.report_out_of_range("reference", rows.text("reference"), builder.train(sequence));
    if (*query >= asked.size() || reference >= frames) continue;
    const size_t reach = rows.frame("tolerance", kMaxGrownFrames);
    const std::string_view label = rows.text("label");
    LabelStretch run{reference, reference, PlaceLabel::different};
    if (label == "same")
      run = {reference - std::min(reach, reference), std::min(reference + reach, frames - 1),
             PlaceLabel::same};
    else if (label != "different")
      rows.fail("label \"{}\" is neither same nor different", label);
    add_label(builder, *query, run, labels[{*query, sequence}]);
    asked[*query].push_back({static_cast<uint32_t>(sequence), static_cast<uint32_t>(reference)});
  }
  for (size_t query = 0; query < asked.size(); ++query)
    for (size_t s = 0; s < builder.scope().sequences.size(); ++s)
      if (rows.has("sequence") || s == only) add_row(builder, query, s, labels[{query, s}]);
  const auto labeled = asked.size() - static_cast<size_t>(std::ranges::count_if(
                                          asked, [](const auto& pairs) { return pairs.empty(); }));
  builder.set_asked(std::move(asked));
  return fmt::format("labels of {} in {} of {}; all other pairs are unknown",
                     counted(rows.size(), "pair"), labeled,
                     counted(builder.query().frames, "query frame"));
}

}  // namespace vpr
