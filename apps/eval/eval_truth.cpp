// vpr-eval check (vpr.ground-truth-check/3) and convert (vpr.conversion/3).
#include <memory>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/json_schema.h"
#include "base/text.h"
#include "database/imported.h"
#include "eval.h"
#include "recordings/frames.h"
#include "recordings/sequence_source.h"
#include "truth/formats.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

/// Numbers of frames; empty: those of the ground truth.
struct ScopeInputs {
  std::string result;
  std::string query;
  std::vector<std::string> train;
  std::optional<uint64_t> query_frames;
  std::optional<uint64_t> train_frames;
};

struct TruthInputs {
  std::string ground_truth;
  std::string target;  ///< format to convert to
  GroundTruthFlags flags;
  ScopeInputs scope;
  TableFormat format = TableFormat::text;
};

size_t count_frames(const SequenceArgument& argument, const Monitor& monitor) {
  if (const auto frames = known_frames(argument)) return *frames;
  return for_each_frame(open_sequence(argument), PixelFormat::gray, Unreadable::skip, monitor,
                        [](size_t, const cv::Mat&) {})
      .frames;
}

GroundTruthScope scope_of_sequences(const ScopeInputs& inputs, const Monitor& monitor) {
  std::vector<SequenceArgument> arguments;
  for (const std::string& text : inputs.train) arguments.push_back(parse_sequence_argument(text));
  const std::vector<std::string> names = sequence_names(arguments);
  GroundTruthScope scope;
  const SequenceArgument query = parse_sequence_argument(inputs.query);
  scope.query.frames = count_frames(query, monitor);
  scope.query_names = [query] { return frame_names(query); };
  for (size_t s = 0; s < arguments.size(); ++s) {
    scope.sequences.push_back({{names[s], count_frames(arguments[s], monitor)}});
    scope.sequences.back().names = [train = arguments[s]] { return frame_names(train); };
  }
  return scope;
}

void add_scope_flags(const Command& command, ScopeInputs& inputs) {
  constexpr const char* kGroup = "Numbers of frames (default: those of the ground truth)";
  command.add_option("--result", inputs.result, "result of vpr-query with these frames", kGroup);
  command.add_option("--query", inputs.query, "query with these frames: folder, list or video",
                     kGroup);
  command.add_list("--train", inputs.train, "training sequence with these frames; repeatable",
                   kGroup);
  command.add_option("--query-frames", inputs.query_frames, "number of query frames", kGroup,
                     "NUMBER");
  command.add_option("--train-frames", inputs.train_frames, "number of training frames", kGroup,
                     "NUMBER");
}

// Videos are read to count their frames.
GroundTruthScope find_scope(const ScopeInputs& inputs, const Monitor& monitor) {
  const bool has_sequences = !inputs.query.empty() || !inputs.train.empty();
  const bool has_numbers = inputs.query_frames || inputs.train_frames;
  if (int{!inputs.result.empty()} + int{has_sequences} + int{has_numbers} > 1)
    throw Error(ErrorKind::usage,
                "the numbers of frames have several sources. Use one: --result, --query with "
                "--train, or --query-frames with --train-frames");
  if (!inputs.result.empty()) return scope_of(read_result(inputs.result, monitor).result);
  if (has_sequences) {
    if (inputs.query.empty() || inputs.train.empty())
      throw Error(ErrorKind::usage, "--query and --train go together");
    return scope_of_sequences(inputs, monitor);
  }
  if (!has_numbers) return {{"", kUnknownFrames}, {{{"", kUnknownFrames}}}};
  if (!inputs.query_frames || !inputs.train_frames)
    throw Error(ErrorKind::usage, "--query-frames and --train-frames go together");
  if (*inputs.query_frames > kMaxGrownFrames || *inputs.train_frames > kMaxGrownFrames)
    throw Error(ErrorKind::usage, "the maximum number of frames is {}", kMaxGrownFrames);
  return {{"", *inputs.query_frames}, {{{"", *inputs.train_frames}}}};
}

/// A count of a check.
struct CheckRow {
  std::string part;  ///< of the JSON file
  std::string key;
  std::string_view meaning;
  std::optional<uint64_t> count;
  const std::vector<std::string>* examples = nullptr;  ///< the first pairs that are counted
};

std::vector<CheckRow> rows_of(const InspectedGroundTruth& found,
                              const GroundTruthSummary& summary) {
  const auto& [out_of_range, contradiction, duplicate] = found.findings;
  return {{"frames", "query", "query frames", summary.query_frames},
          {"frames", "train", "training frames", summary.train_frames},
          {"pairs", "same", "pairs of the same place, tolerance applied", summary.same},
          {"pairs", "ignored", "pairs to ignore", summary.ignored},
          {"pairs", "most_matches", "most matches of one query", summary.most_matches},
          {"findings", "out_of_range", "pairs out of range: damage", out_of_range.count,
           &out_of_range.examples},
          {"findings", "contradiction", "pairs labeled both same and ignore: damage",
           contradiction.count, &contradiction.examples},
          {"findings", "duplicate", "pairs given more than once; they count once", duplicate.count,
           &duplicate.examples},
          {"findings", "queries_without_match", "queries without a match; counted apart",
           summary.queries_without_match},
          {"findings", "train_frames_without_match", "training frames that no query matches",
           summary.train_frames_without_match},
          {"findings", "one_sided", "pairs (i, j) without (j, i); usual between two sequences",
           summary.one_sided, &summary.one_sided_examples}};
}

/// "count" and "examples" of a finding.
struct CountedPairs {
  uint64_t count = 0;
  std::vector<std::string> examples;
};
VPR_FIELDS(CountedPairs, (count, "How many."), (examples, "At most 5 of them."))

/// The findings of vpr-eval check.
struct CheckFile {
  std::string format, protocol;
  std::vector<CheckRow> rows;
  Provenance provenance;
};

template <class Visitor>
void visit_part(const std::vector<CheckRow>& rows, std::string_view part, Visitor&& visit) {
  for (const CheckRow& row : rows) {
    if (row.part != part) continue;
    if (row.examples == nullptr)
      visit(row.key, Derived{row.count.value_or(0)}, row.meaning);
    else if (row.count)
      visit(row.key, Derived{CountedPairs{*row.count, *row.examples}}, row.meaning);
    else
      visit(row.key, Derived{std::optional<CountedPairs>()}, row.meaning);
  }
}

template <class Visitor>
void visit_fields(CheckFile& file, Visitor&& visit) {
  visit("schema", Derived{schema_name("ground-truth-check")});
  visit("format", file.format, "Format that was read.");
  visit("protocol", file.protocol, "Definition, in words.");
  const auto visit_rows = [&](const char* part, std::string_view text) {
    visit(part, NestedObject{[&](auto&& inner) { visit_part(file.rows, part, inner); }}, text);
  };
  visit_rows("frames", "Frames that the ground truth is about.");
  visit_rows("pairs", "Pairs of a query frame and a training frame.");
  visit_rows("findings",
             "Suspicious pairs; null for one_sided unless there are as many query frames as "
             "training frames.");
  visit("provenance", file.provenance, kProvenanceText);
}

/// The output of vpr-eval convert --json.
struct Conversion {
  std::string from, to;
  uint64_t query_frames = 0, same = 0, ignored = 0;
};

VPR_FILE(Conversion, "conversion", (from, "Format that was read."),
         (to, "Format that was written."), (query_frames, "Query frames."),
         (same, "Pairs of the same place, tolerance applied."), (ignored, "Pairs to ignore."))

Json check_json(const InspectedGroundTruth& found, const std::vector<CheckRow>& rows,
                const RunInfo& run) {
  CheckFile file{found.format, found.truth.protocol, rows, provenance_of(run)};
  Json json = value_to_json(file, kDataForm);
  json["machine"] = machine_json(run);
  return json;
}

/// A row per count, with its meaning; as text with the first pairs of findings, one per line.
std::string check_text(const std::string& title, const std::vector<CheckRow>& rows,
                       TableFormat format) {
  Table table{title, {"what", "count"}, {}};
  std::string examples;
  for (const CheckRow& row : rows) {
    add_row(table, row.meaning, row.count ? std::to_string(*row.count) : "-");
    if (row.count && row.examples != nullptr)
      for (const std::string& example : *row.examples) examples += example + "\n";
  }
  return render_table(table, format) + (format == TableFormat::text ? examples : "");
}

InspectedGroundTruth inspect(const Session& session, const TruthInputs& inputs,
                             const GroundTruthScope& scope) {
  return inspect_ground_truth(ground_truth_argument(inputs.ground_truth, inputs.flags), scope,
                              session.monitor);
}

void run_check(Session& session, const TruthInputs& inputs) {
  session.claim_output();
  const InspectedGroundTruth found =
      inspect(session, inputs, find_scope(inputs.scope, session.monitor));
  const GroundTruthSummary summary = summarize(found, session.monitor);
  const std::vector<CheckRow> rows = rows_of(found, summary);
  const Json json = check_json(found, rows, session.run);
  session.write_output(json);
  session.print_result(check_text(found.truth.protocol, rows, inputs.format), json);
  require_undamaged(found, inputs.ground_truth);
}

bool is_written(const GroundTruthFormat& format) { return format.write != nullptr; }

void run_convert(Session& session, const TruthInputs& inputs) {
  const CommonOptions& options = session.options;
  if (options.output.empty())
    throw Error(ErrorKind::usage, "the output file is missing. Add it, as in -o pairs.csv");
  const GroundTruthFormat& target = find_format(inputs.target);
  if (!is_written(target))
    throw Error(ErrorKind::usage, "{} cannot be written. Use --to with {}", target.name,
                format_names(is_written));
  session.claim_output();
  const InspectedGroundTruth found =
      inspect(session, inputs, recorded(find_scope(inputs.scope, session.monitor)));
  require_undamaged(found, inputs.ground_truth);
  if (!found.truth.asked.empty())
    throw Error(ErrorKind::usage, "{}: most pairs are unknown, and no other format has such pairs",
                inputs.ground_truth);
  const GroundTruthSummary summary = summarize(found, session.monitor);
  const bool holds_ignored = target.ignores_in.empty() ||
                             std::filesystem::path(options.output).extension() == target.ignores_in;
  if (summary.ignored > 0 && !holds_ignored)
    warn(session.monitor, "{} labeled ignore become different, since {} has no such label",
         counted(summary.ignored, "pair"), target.name);
  target.write(found, session.outputs.file(options.output), session.monitor);
  session.print_result(
      fmt::format("{} ({}) to {} ({}): {}, {} of the same place, {} ignored\n", inputs.ground_truth,
                  found.format, options.output, target.name,
                  counted(summary.query_frames, "query frame"), counted(summary.same, "pair"),
                  summary.ignored),
      value_to_json(Conversion{found.format, std::string(target.name), summary.query_frames,
                               summary.same, summary.ignored},
                    kDataForm));
}

}  // namespace

Json check_schema() {
  const InspectedGroundTruth found;
  const GroundTruthSummary summary;
  CheckFile file{{}, {}, rows_of(found, summary), {}};
  return with_run(field_schema(file, SchemaForm::data), false);
}

Json conversion_schema() { return schema_of<Conversion>(); }

void add_check(Program& program) {
  const auto inputs = std::make_shared<TruthInputs>();
  const Command command = program.add_command(
      "check",
      "Check a ground truth for mistakes. Indices out of range and contradictions have exit code "
      "4; duplicates, one-sided pairs and queries without a match are listed.",
      "  vpr-eval check pairs.csv --query tuesday --train monday\n"
      "  vpr-eval check GT.npz --json",
      [inputs](Session& session) { run_check(session, *inputs); });
  command.add_option("GROUND-TRUTH", inputs->ground_truth, ground_truth_help()).required();
  add_format_flag(command, inputs->format);
  add_ground_truth_flags(command, inputs->flags);
  add_scope_flags(command, inputs->scope);
}

void add_convert(Program& program) {
  const auto inputs = std::make_shared<TruthInputs>();
  const Command command = program.add_command(
      "convert", "Convert a ground truth to another format.",
      "  vpr-eval convert pairs.csv --query tuesday --train monday --to matrix -o matrix.npy\n"
      "  vpr-eval convert ground_truth_new.npy --to pairs -o pairs.csv\n"
      "  vpr-eval convert query.csv --ground-truth-train ref.csv --radius 5 --to matrix "
      "-o GT.npz\n"
      "  vpr-eval convert aligned --tolerance 3 --query-frames 111 --train-frames 111 --to pairs "
      "-o aligned.csv",
      [inputs](Session& session) { run_convert(session, *inputs); });
  command.add_option("GROUND-TRUTH", inputs->ground_truth, ground_truth_help()).required();
  command.add_option("--to", inputs->target, "output format: " + format_names(is_written))
      .required();
  add_ground_truth_flags(command, inputs->flags, "--from,--ground-truth-format");
  add_scope_flags(command, inputs->scope);
}

}  // namespace vpr
