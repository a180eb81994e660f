// vpr-bench: measures the time of each step on this machine.

#include "base/error.h"
#include "bench/benches.h"
#include "common/flags.h"
#include "database/frame_descriptors.h"

namespace vpr {
namespace {

/// A benchmark with its inputs and outputs; each benchmark uses some of the inputs.
template <class Settings>
struct Bench {
  Settings settings;
  std::string database;
  std::string train;
  std::string query;
  std::string images;
  std::string plots;
  TableFormat format = TableFormat::text;
};

/// A flag with a list of values, separated by commas.
template <class T>
void add_values(const Command& command, const std::string& flag, std::vector<T>& values,
                const std::string& help) {
  const bool is_text = std::is_same_v<T, std::string>;
  command
      .add_option(flag, values, is_text ? help : help + ", as in 20,40,60", kEssentialGroup,
                  is_text ? "NAMES" : "NUMBERS")
      .comma_separated();
}

std::string report_text(const BenchResult& result, TableFormat format) {
  if (format == TableFormat::csv) return render_table(rows_table(result), format);
  std::string text;
  for (const Table& table : readable_tables(result))
    text += (text.empty() ? "" : "\n") + render_table(table, format);
  for (const std::string& sentence : result.left_out) text += "Left out: " + sentence + ".\n";
  return text;
}

/// A command that claims its outputs, pins the process, calls `run`, and presents the result.
template <class Settings>
std::pair<Command, Bench<Settings>&> add_bench(
    Program& program, const std::string& name, const std::string& description,
    const std::string& example,
    std::function<BenchResult(const Bench<Settings>&, const Session&)> run) {
  const auto bench = std::make_shared<Bench<Settings>>();
  const auto run_bench = [bench, run](Session& session) {
    session.claim_output({}, bench->plots);
    pin_to_cores(session.run.threads);
    const BenchResult result = run(*bench, session);
    const Json json = bench_json(result, session.run);
    session.write_output(json);
    if (!bench->plots.empty()) {
      const Output& folder = session.outputs.folder(bench->plots, is_marked_folder);
      for (const Chart& chart : result.charts)
        if (!chart.series.empty()) draw_chart(chart, folder.temporary());
    }
    session.print_result(report_text(result, bench->format), json);
  };
  const Command command = program.add_command(name, description, example, run_bench);
  program.add_config(command, bench->settings);
  add_format_flag(command, bench->format).group("Reports");
  command.add_option("--plot", bench->plots, "folder for plots (SVG, PDF and PNG)", "Reports");
  return {command, *bench};
}

std::vector<LdbCode> describe(const std::string& path, const Monitor& monitor) {
  return ldb_codes(descriptor_kind("ldb").describe(open_sequence(parse_sequence_argument(path)), {},
                                                   Unreadable::fail, monitor));
}

BenchResult run_matching(const Bench<MatchingBenchSettings>& bench, const Session& session) {
  if (bench.train.empty() != bench.query.empty())
    throw Error(ErrorKind::usage, "--train and --query belong together: pass both or neither");
  if (!bench.train.empty() && bench.settings.descriptor_length != 0)
    throw Error(ErrorKind::usage, "--descriptor-length has no effect on --train; omit one of them");
  refuse(session.command.is_given("--value-bits") && bench.settings.descriptor_length == 0,
         "--value-bits", "has no effect without --descriptor-length");
  std::optional<RecordedCodes> recorded;
  if (!bench.train.empty())
    recorded = {describe(bench.train, session.monitor), describe(bench.query, session.monitor)};
  return bench_matching(bench.settings, recorded, session.options.process.seed, session.monitor);
}

void add_matching(Program& program) {
  auto [command, bench] = add_bench<MatchingBenchSettings>(
      program, "matching",
      "Time matching by database size and window length (tables 5 to 7 of the paper).",
      "  vpr-bench matching --databases 1000,8000 --c-l 20,80 -o new.json\n"
      "  vpr-bench matching --databases 1000,10000,100000 --c-l 300\n"
      "  vpr-bench matching --train monday --query tuesday --databases 1000\n"
      "  vpr-bench matching --descriptor-length 512 --databases 100000 --c-l 20",
      run_matching);
  MatchingBenchSettings& settings = bench.settings;
  add_values(command, "--methods", settings.methods,
             "methods: fastable-online, fastable, zscore, filter, openable, lsh");
  add_values(command, "--databases", settings.databases, "database sizes in frames");
  add_values(command, "--c-l", settings.window_lengths, "window lengths c_l");
  add_values(command, "--query-frames", settings.query_frames, "query lengths in frames");
  add_setting(command, "--descriptor-length", settings.descriptor_length,
              "dimensions of generated vectors to compare (default: 0, LDB codes)");
  add_setting(command, "--value-bits", settings.precision,
              "bits per value of these vectors: 16 or 8 (default: 16)");
  add_setting(command, "--seconds", settings.seconds,
              "minimum time of a measurement in seconds (default: 0.3)");
  command.add_option("--train", bench.train,
                     "training frames (default: generated LDB codes); needs --query");
  command.add_option("--query", bench.query, "query frames for --train");
}

BenchResult run_describe(const Bench<DescribeBenchSettings>& bench, const Session& session) {
  std::optional<SequenceSource> images;
  if (!bench.images.empty()) images = open_sequence(parse_sequence_argument(bench.images));
  return bench_describe(bench.settings, images, session.options.process.seed, session.monitor);
}

void add_describe(Program& program) {
  auto [command, bench] = add_bench<DescribeBenchSettings>(
      program, "describe", "Time decoding, descriptors and local features per frame.",
      "  vpr-bench describe --images monday -o describe.json", run_describe);
  command.add_option("--images", bench.images, "folder or list of images (default: generated)");
  add_values(command, "--features", bench.settings.feature_kinds,
             "local features: surf, sift, kaze, akaze, orb, brisk (default: all)");
  add_setting(command, "--frames", bench.settings.frames,
              "number of different frames (default: 20)");
  add_setting(command, "--seconds", bench.settings.seconds,
              "shortest time of a measurement in seconds (default: 1)");
}

void add_fabmap(Program& program) {
  auto [command, bench] = add_bench<FabmapBenchSettings>(
      program, "fabmap", "Time FAB-MAP queries by number of places.",
      "  vpr-bench fabmap --place-counts 1000,10000 --variants fabmap2,fbo",
      [](const Bench<FabmapBenchSettings>& fabmap, const Session& session) {
        return bench_fabmap(fabmap.settings, session.options.process.seed, session.monitor);
      });
  FabmapBenchSettings& settings = bench.settings;
  add_values(command, "--variants", settings.variants,
             "variants: fabmap2, fbo, lut, fabmap1 (default: all)");
  add_values(command, "--place-counts", settings.place_counts, "numbers of places");
  add_values(command, "--words", settings.words, "sizes of the vocabulary");
  add_values(command, "--words-per-frame", settings.words_per_frame, "words per frame");
  add_setting(command, "--count", settings.descriptors,
              "descriptors to cluster with k-means; 0: skip it (default: 20000)");
  add_setting(command, "--frame-ms", settings.frame_ms,
              "time of a frame's features, included in frames per second, in ms (default: 0)");
  add_setting(command, "--seconds", settings.seconds,
              "shortest time of a measurement in seconds (default: 0.3)");
}

void add_training(Program& program) {
  auto [command, bench] = add_bench<TrainingBenchSettings>(
      program, "training", "Time training by database size, without describing frames.",
      "  vpr-bench training --databases 20000,40000,80000 --threads 0",
      [](const Bench<TrainingBenchSettings>& training, const Session& session) {
        return bench_training(training.settings, session.options.process.seed, session.monitor);
      });
  add_values(command, "--databases", bench.settings.databases, "database sizes in frames");
  add_setting(command, "--descriptor-length", bench.settings.descriptor_length,
              "dimensions of generated vectors (default: 464)");
  add_setting(command, "--value-bits", bench.settings.precision,
              "bits per value of these vectors: 16 or 8 (default: 16)");
}

BenchResult run_realtime(const Bench<RealtimeBenchSettings>& bench, const Session& session) {
  for (const char* flag : {"--c-l", "--score"})
    refuse(bench.settings.method == "filter" && session.command.is_given(flag), flag,
           "has no effect on --method filter; omit one of them");
  const SequenceSource query = open_sequence(parse_sequence_argument(bench.query));
  QueryResources resources;
  resources.seed = session.options.process.seed;
  return bench_realtime(bench.database, query, bench.settings, resources, session.monitor);
}

void add_realtime(Program& program) {
  auto [command, bench] = add_bench<RealtimeBenchSettings>(
      program, "realtime",
      "Replay a recording at its frame rate, as vpr-query live processes it: latency and "
      "missed deadlines.",
      "  vpr-bench realtime corridor.vprdb --query tuesday --rate 10\n"
      "  vpr-bench realtime corridor.vprdb --query tuesday --rate 30 --method filter",
      run_realtime);
  RealtimeBenchSettings& settings = bench.settings;
  command.add_option("DB", bench.database, "database of a sequence method").required();
  command.add_option("--query", bench.query, "folder or list of images").required();
  add_setting(command, "--method", settings.method,
              "matching method: fastable or filter (default: fastable)")
      .choices("METHOD", {"fastable", "filter"});
  add_setting(command, "--score", settings.score, "window score: raw or zscore (default: raw)");
  add_setting(command, "--rate", settings.rate_hz, "frames per second (default: 10)");
  add_setting(command, "--query-frames", settings.frames,
              "number of query frames, at most those of the query (default: 100)");
  add_setting(command, "--c-l", settings.window_length,
              "window length c_l in frames (default: 40)");
}

struct CompareOptions {
  std::string older;
  std::string newer;
  double factor = 1.2;
  TableFormat format = TableFormat::text;
};

void compare(Session& session, const CompareOptions& options) {
  if (!(options.factor > 0))
    throw Error(ErrorKind::usage, "--factor must be above 0, found {}", options.factor);
  session.claim_output();
  const BenchComparison comparison =
      compare_benches(read_bench(options.older), read_bench(options.newer));
  const Json json = comparison_json(comparison, options.factor);
  session.write_output(json);
  std::string text = render_table(comparison_table(comparison, options.factor), options.format);
  if (options.format != TableFormat::csv)
    for (const std::string& name : comparison.only_in_one) text += name + "\n";
  session.print_result(text, json);
  const size_t slower = count_slower(comparison, options.factor);
  if (slower > 0)
    throw Error(ErrorKind::expectation, "{} of {} times are above {} times the old ones", slower,
                comparison.ratios.size(), options.factor);
}

void add_compare(Program& program) {
  const auto options = std::make_shared<CompareOptions>();
  const Command command = program.add_command(
      "compare", "Compare two runs on one machine; exit code 5 if the new one is slower.",
      "  vpr-bench compare old.json new.json --factor 2",
      [options](Session& session) { compare(session, *options); });
  program.add_config(command);
  command.add_option("OLD", options->older, "result of the old run").required();
  command.add_option("NEW", options->newer, "result of the new run").required();
  add_setting(command, "--factor", options->factor,
              "largest ratio of times that is not slower (default: 1.2)");
  add_format_flag(command, options->format);
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program(
      "vpr-bench",
      "Measure times on this machine, on one core unless --threads is set. Distances are verified "
      "before they are timed.",
      "  vpr-bench matching --databases 1000,8000 --c-l 20,80 -o old.json");
  program.set_default_threads(1);
  add_matching(program);
  add_describe(program);
  add_training(program);
  add_fabmap(program);
  add_realtime(program);
  add_compare(program);
  return program.main(argc, argv);
}
