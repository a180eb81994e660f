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

LabelStretch stretch_of(const PersonLabel& label, size_t frames) {
  const size_t reference = label.reference.value();
  if (!label.is_same) return {reference, reference, PlaceLabel::different};
  return {reference - std::min(label.tolerance, reference),
          std::min(reference + label.tolerance, frames - 1), PlaceLabel::same};
}

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

// The label of the current row; nullopt if it is outside the range, or out of range, which is
// reported. `only`: its sequence, if the file names none.
std::optional<PersonLabel> read_label(GroundTruthBuilder& builder, const Rows& rows,
                                      const FrameRange& range, size_t only) {
  const auto query = frame_in_range(range, rows.frame("query", kMaxGrownFrames));
  if (!query) return std::nullopt;
  const std::string_view label = rows.text("label");
  const std::string_view why = rows.text("asked");
  if (!why.empty() && why != kAskedSpread && why != kAskedNear)
    rows.fail("asked \"{}\" is neither {} nor {}", why, kAskedSpread, kAskedNear);
  if (*query >= builder.query().frames) {
    builder.report_out_of_range("query", rows.text("query"), builder.query());
    return std::nullopt;
  }
  if (why == kAskedSpread && label.empty() && rows.text("reference").empty())
    return PersonLabel{.query = *query, .is_spread = true};
  const size_t sequence =
      rows.has("sequence") ? builder.find_sequence(rows.text("sequence")) : only;
  const size_t reference = rows.frame("reference", kMaxGrownFrames);
  if (reference >= builder.train(sequence).frames) {
    builder.report_out_of_range("reference", rows.text("reference"), builder.train(sequence));
    return std::nullopt;
  }
  const size_t reach = rows.frame("tolerance", kMaxGrownFrames);
  if (label != "same" && label != "different")
    rows.fail("label \"{}\" is neither same nor different", label);
  return PersonLabel{*query,          static_cast<uint32_t>(sequence), reference,
                     label == "same", label == "same" ? reach : 0,     why == kAskedSpread};
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
  Rows rows(source.path, name,
            {{"query", "reference", "label", "tolerance", "sequence", "asked"}, 4});
  if (rows.size() == 0)
    rows.fail("has no labels. Answer the page of vpr-eval --ask-frames and save it again");
  const size_t only = rows.has("sequence") ? 0 : builder.only_searched(name);
  std::map<std::pair<size_t, size_t>, RowLabels> all;
  std::vector<PersonLabel> labels;
  while (rows.next()) {
    builder.at("line", rows.line());
    const auto label = read_label(builder, rows, source.range, only);
    if (!label) continue;
    labels.push_back(*label);
    if (label->reference)
      add_label(builder, label->query, stretch_of(*label, builder.train(label->sequence).frames),
                all[{label->query, label->sequence}]);
  }
  const bool is_sample = std::ranges::any_of(labels, &PersonLabel::is_spread);
  std::map<std::pair<size_t, size_t>, RowLabels> counted_labels;
  std::vector<std::vector<GroundTruth::Pair>> asked(builder.query().frames);
  size_t near = 0;  // the decision: not in the sample
  size_t counted_pairs = 0;
  for (const PersonLabel& one : labels) {
    near += is_sample && !one.is_spread;
    if (is_sample && !one.is_spread) continue;
    if (!one.reference) {
      asked[one.query].push_back({0, 0, PlaceLabel::ignore});
      continue;
    }
    ++counted_pairs;
    counted_labels[{one.query, one.sequence}].push_back(
        stretch_of(one, builder.train(one.sequence).frames));
    asked[one.query].push_back({one.sequence, static_cast<uint32_t>(*one.reference)});
  }
  for (size_t query = 0; query < asked.size(); ++query)
    for (size_t s = 0; s < builder.scope().sequences.size(); ++s)
      if (rows.has("sequence") || s == only) add_row(builder, query, s, counted_labels[{query, s}]);
  const auto labeled = asked.size() - static_cast<size_t>(std::ranges::count_if(
                                          asked, [](const auto& pairs) { return pairs.empty(); }));
  builder.set_labels(std::move(asked), std::move(labels), is_sample);
  return fmt::format("labels of {} in {} of {}{}{}; all other pairs are unknown",
                     counted(counted_pairs, "pair"), labeled,
                     counted(builder.query().frames, "query frame"),
                     is_sample ? ", a sample spread along the query" : "",
                     near > 0 ? fmt::format(" ({} near the decision only set the threshold)",
                                            counted(near, "further one"))
                              : "");
}

}  // namespace vpr
