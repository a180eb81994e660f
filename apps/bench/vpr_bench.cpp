// vpr-bench: times of each step on this machine.
#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "bench/bench_result.h"
#include "bench/bench_tables.h"
#include "bench/describe_bench.h"
#include "bench/fabmap_bench.h"
#include "bench/matching_bench.h"
#include "bench/realtime_bench.h"
#include "common/command.h"
#include "describe/frame_descriptors.h"
#include "run/plan.h"
#include "run/train.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

/// What all benchmarks share.
struct Presentation {
  TableFormat format = TableFormat::text;
  std::string plots;  ///< a folder to draw them into
};

void add_presentation(const Command& command, Presentation& presentation) {
  add_setting(command, "--format", presentation.format,
              "of the table: text (default), csv, markdown or latex");
  command.add_option("--plot", presentation.plots, "folder for plots (SVG and PNG)");
}

/// A list of numbers, as in 20,40,60.
Flag add_numbers(const Command& command, const std::string& flag, std::vector<uint64_t>& values,
                 const std::string& help) {
  return command.add_option(flag, values, help + ", as in 20,40,60")
      .comma_separated()
      .type_name("NUMBERS");
}

Flag add_names(const Command& command, const std::string& flag, std::vector<std::string>& values,
               const std::string& help) {
  return command.add_option(flag, values, help).comma_separated().type_name("NAMES");
}

void claim_outputs(const Session& session, const Presentation& presentation) {
  session.claim_output();
  if (!presentation.plots.empty())
    session.outputs.claim_folder(presentation.plots, is_marked_folder);
}

std::string report_text(const BenchResult& result, TableFormat format) {
  if (format == TableFormat::csv) return render_table(rows_table(result), format);
  std::string text;
  for (const Table& table : readable_tables(result))
    text += (text.empty() ? "" : "\n") + render_table(table, format);
  for (const std::string& sentence : result.left_out) text += "Left out: " + sentence + ".\n";
  return text;
}

void present(Session& session, const BenchResult& result, const Presentation& presentation) {
  session.run.simd_target = session.kernels.target;
  const Json json = bench_json(result, session.run);
  session.write_output(json);
  if (!presentation.plots.empty()) {
    const Output& folder = session.outputs.folder(presentation.plots, is_marked_folder);
    for (const Chart& chart : result.charts)
      if (!chart.series.empty()) draw_chart(chart, folder.temporary());
  }
  session.print_result(report_text(result, presentation.format), json);
}

/// One benchmark: its settings, and how it is run.
template <class Settings>
struct Bench {
  Settings settings;
  Presentation presentation;
};

/// A command that checks outputs, pins the process, runs, and presents.
template <class Settings, class Run>
Command add_bench(Program& program, Bench<Settings>& bench, const std::string& name,
                  const std::string& description, const std::string& example, Run&& run) {
  const Command command =
      program.add_command(name, description, example, [&bench, run](Session& session) {
        claim_outputs(session, bench.presentation);
        pin_to_cores(session.run.threads);
        present(session, run(session, bench.settings), bench.presentation);
      });
  program.add_config(command, bench.settings);
  add_presentation(command, bench.presentation);
  return command;
}

std::vector<LdbCode> describe(const std::string& path, const Monitor& monitor) {
  return ldb_codes(descriptor_kind("ldb").describe(open_sequence(parse_sequence_argument(path)), {},
                                                   Unreadable::fail, monitor));
}

/// Real frames for vpr-bench matching.
struct RecordedInputs {
  std::string train;
  std::string query;
};

BenchResult run_matching(Session& session, const RecordedInputs& inputs,
                         const MatchingBenchSettings& settings) {
  if (inputs.train.empty() != inputs.query.empty())
    throw Error(ErrorKind::usage, "--train and --query belong together: pass both or neither");
  if (!inputs.train.empty() && settings.descriptor_length != 0)
    throw Error(ErrorKind::usage, "--descriptor-length has no effect on --train; omit one of them");
  std::optional<RecordedCodes> recorded;
  if (!inputs.train.empty())
    recorded = {describe(inputs.train, session.monitor), describe(inputs.query, session.monitor)};
  BenchResult result =
      bench_matching(settings, recorded, session.options.seed, session.kernels, session.monitor);
  add_matching_comparisons(result, settings);
  return result;
}

void add_matching(Program& program, Bench<MatchingBenchSettings>& bench, RecordedInputs& inputs) {
  const Command command = add_bench(
      program, bench, "matching",
      "Time matching against database size and window length (the paper's tables 5 to 7).",
      "  vpr-bench matching -o matching.json --plot plots\n"
      "  vpr-bench matching --databases 1000,10000,100000 --c-l 300\n"
      "  vpr-bench matching --train summer.mp4 --query winter.mp4 --databases 1000\n"
      "  vpr-bench matching --descriptor-length 512 --databases 100000 --c-l 20",
      [&inputs](Session& session, const MatchingBenchSettings& settings) {
        return run_matching(session, inputs, settings);
      });
  add_names(command, "--methods", bench.settings.methods,
            "methods: fastable-online, fastable, zscore, filter, openable, lsh");
  add_numbers(command, "--databases", bench.settings.databases, "database sizes in frames");
  add_numbers(command, "--c-l", bench.settings.window_lengths, "window lengths c_l");
  add_numbers(command, "--query-frames", bench.settings.query_frames, "query lengths in frames");
  add_setting(command, "--descriptor-length", bench.settings.descriptor_length,
              "dimensions of generated vectors to compare (default: 0, LDB codes)");
  add_setting(command, "--precision", bench.settings.precision,
              "bits per value of these vectors: 16 or 8 (default: 16)");
  add_setting(command, "--seconds", bench.settings.seconds,
              "least time of a measurement (default: 0.3)");
  command.add_option("--train", inputs.train,
                     "training frames (default: generated LDB codes); needs --query");
  command.add_option("--query", inputs.query, "query frames for --train");
}

void add_describe(Program& program, Bench<DescribeBenchSettings>& bench, std::string& images) {
  const Command command =
      add_bench(program, bench, "describe", "Decoding, LDB and every local feature, per frame.",
                "  vpr-bench describe --images walk -o describe.json",
                [&images](Session& session, const DescribeBenchSettings& settings) {
                  std::optional<SequenceSource> sequence;
                  if (!images.empty()) sequence = open_sequence(parse_sequence_argument(images));
                  return bench_describe(settings, sequence, session.options.seed, session.monitor);
                });
  command.add_option("--images", images, "folder or list of images; without it, generated ones");
  add_names(command, "--features", bench.settings.features,
            "of surf, sift, kaze, akaze, orb, brisk");
  add_setting(command, "--frames", bench.settings.frames, "different frames (default 20)");
  add_setting(command, "--seconds", bench.settings.seconds, "of each measurement (default 1)");
}

void add_fabmap(Program& program, Bench<FabmapBenchSettings>& bench) {
  const Command command =
      add_bench(program, bench, "fabmap", "FAB-MAP's query time against the number of places.",
                "  vpr-bench fabmap --places 10000,100000,1000000 --variants fabmap2,fabmap2-fixed",
                [](Session& session, const FabmapBenchSettings& settings) {
                  return bench_fabmap(settings, session.options.seed, session.monitor);
                });
  add_names(command, "--variants", bench.settings.variants,
            "of fabmap2, fabmap2-fixed, fbo, lut, fabmap1");
  add_numbers(command, "--places", bench.settings.places, "numbers of places");
  add_numbers(command, "--words", bench.settings.words, "sizes of the vocabulary");
  add_numbers(command, "--words-per-frame", bench.settings.words_per_frame, "words of a frame");
  add_setting(command, "--descriptors", bench.settings.descriptors,
              "that k-means makes words of (default 20000; 0: none)");
  add_setting(command, "--seconds", bench.settings.seconds, "of each measurement (default 0.3)");
}

struct RealtimeInputs {
  std::string database;
  std::string query;
};

BenchResult run_realtime(Session& session, const RealtimeInputs& inputs,
                         const RealtimeBenchSettings& settings) {
  const SequenceSource query = open_sequence(parse_sequence_argument(inputs.query));
  SequenceDatabase database = read_sequence_database(inputs.database);
  if (database.descriptors.kind->is_imported)
    throw Error(ErrorKind::data,
                fmt::format("{}: has imported descriptors. Frames cannot be described alike",
                            inputs.database));
  if (score_kind(live_settings(settings)->score).needs_statistics)
    ensure_statistics(database, session.monitor);
  QueryResources resources;
  resources.kernels = session.kernels;
  resources.seed = session.options.seed;
  return bench_realtime(database, query, settings, resources, session.monitor);
}

void add_realtime(Program& program, Bench<RealtimeBenchSettings>& bench, RealtimeInputs& inputs) {
  const Command command =
      add_bench(program, bench, "realtime",
                "Replay a recording at its frame rate, as vpr-query --follow processes it: latency "
                "and missed "
                "deadlines.",
                "  vpr-bench realtime corridor.vprdb --query corridor/query --rate 10\n"
                "  vpr-bench realtime corridor.vprdb --query walk --rate 30 --method filter",
                [&inputs](Session& session, const RealtimeBenchSettings& settings) {
                  return run_realtime(session, inputs, settings);
                });
  command.add_option("DB", inputs.database, "database of a sequence method").required();
  command.add_option("--query", inputs.query, "folder or list of images").required();
  add_setting(command, "--method", bench.settings.method,
              "matching method: fastable or filter (default: fastable)")
      .choices("METHOD", {"fastable", "filter"});
  add_setting(command, "--score", bench.settings.score,
              "window score: raw or zscore (default: raw)");
  add_setting(command, "--rate", bench.settings.rate_hz, "frames per second (default: 10)");
  add_setting(command, "--frames", bench.settings.frames,
              "largest number of query frames (default: 100)");
  add_setting(command, "--c-l", bench.settings.window_length,
              "window length c_l in frames (default: 40)");
}

struct CompareInputs {
  std::string older;
  std::string newer;
  double factor = 1.2;
  TableFormat format = TableFormat::text;
};

void compare(Session& session, const CompareInputs& inputs) {
  if (!(inputs.factor > 0))
    throw Error(ErrorKind::usage, fmt::format("--factor must be above 0, found {}", inputs.factor));
  session.claim_output();
  const BenchComparison comparison =
      compare_benches(read_bench(inputs.older), read_bench(inputs.newer));
  const Json json = comparison_json(comparison, inputs.factor);
  session.write_output(json);
  std::string text = render_table(comparison_table(comparison, inputs.factor), inputs.format);
  if (inputs.format != TableFormat::csv)
    for (const std::string& name : comparison.only_in_one) text += name + "\n";
  session.print_result(text, json);
  const size_t slower = count_slower(comparison, inputs.factor);
  if (slower > 0)
    throw Error(ErrorKind::expectation,
                fmt::format("{} of {} times are above {} times the old ones", slower,
                            comparison.ratios.size(), inputs.factor));
}

void add_compare(Program& program, CompareInputs& inputs, NoSettings& none) {
  const Command command = program.add_command(
      "compare", "Two runs on one machine: ratios, and exit code 5 where the new one is slower.",
      "  vpr-bench compare old.json new.json --factor 1.2",
      [&inputs](Session& session) { compare(session, inputs); });
  program.add_config(command, none);
  command.add_option("OLD", inputs.older, "an earlier run").required();
  command.add_option("NEW", inputs.newer, "a later one").required();
  add_setting(command, "--factor", inputs.factor, "a larger ratio is too slow (default 1.2)");
  add_setting(command, "--format", inputs.format,
              "of the table: text (default), csv, markdown or latex");
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program(
      "vpr-bench",
      "Measure times on this machine, on one core unless --threads is set. Distances are verified "
      "before they are timed.",
      "  vpr-bench matching --databases 1000,8000 --c-l 20,80 -o matching.json");
  program.set_default_threads(1);
  Bench<MatchingBenchSettings> matching;
  RecordedInputs recorded;
  add_matching(program, matching, recorded);
  Bench<DescribeBenchSettings> describe;
  std::string images;
  add_describe(program, describe, images);
  Bench<FabmapBenchSettings> fabmap;
  add_fabmap(program, fabmap);
  Bench<RealtimeBenchSettings> realtime;
  RealtimeInputs realtime_inputs;
  add_realtime(program, realtime, realtime_inputs);
  CompareInputs compared;
  NoSettings none;
  add_compare(program, compared, none);
  return program.main(argc, argv);
}
