// vpr-bench: how long everything takes on this machine, beside the paper's times.
#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "bench/bench_file.h"
#include "bench/bench_tables.h"
#include "bench/describe_bench.h"
#include "bench/fabmap_bench.h"
#include "bench/matching_bench.h"
#include "bench/nordland_bench.h"
#include "bench/realtime_bench.h"
#include "bench/replay_work.h"
#include "bench_compare.h"
#include "common/command.h"
#include "database/family.h"
#include "descriptors/frame_descriptors.h"
#include "images/sequence.h"
#include "pipeline/score_basis.h"
#include "pipeline/train.h"

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
  if (!result.paper.empty()) text += "\n" + render_table(paper_table(result), format);
  return text;
}

void present(Session& session, const BenchResult& result, const Presentation& presentation) {
  session.run.simd_target = session.kernels.target;
  const Json json = bench_json(result, session.run);
  session.write_output(json);
  if (!presentation.plots.empty()) {
    const OutputFolder& folder = session.outputs.folder(presentation.plots, is_marked_folder);
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

void add_matching(Program& program, Bench<MatchingBenchSettings>& bench) {
  const Command command = add_bench(
      program, bench, "matching", "Matching time against database size and window length (tab6).",
      "  vpr-bench matching -o matching.json --plot plots\n"
      "  vpr-bench matching --query-frames 500,1000,1500,2000 --databases 8000 --c-l 40\n"
      "  vpr-bench matching --descriptor-length 512 --databases 100000 --c-l 20",
      [](Session& session, const MatchingBenchSettings& settings) {
        BenchResult result =
            bench_matching(settings, session.options.seed, session.kernels, session.monitor);
        add_matching_comparisons(result, settings);
        return result;
      });
  add_names(command, "--methods", bench.settings.methods,
            "of fastable-online, fastable, standardized, filter, openable, lsh, plain-fastable, "
            "plain-openable");
  add_numbers(command, "--databases", bench.settings.databases, "database sizes in frames");
  add_numbers(command, "--c-l", bench.settings.window_lengths, "window lengths c_l");
  add_numbers(command, "--query-frames", bench.settings.query_frames, "query lengths in frames");
  add_setting(command, "--descriptor-length", bench.settings.descriptor_length,
              "vectors of so many numbers, as of a network, instead of LDB codes");
  add_setting(command, "--precision", bench.settings.precision,
              "bits of a number of these vectors: 16 (default) or 8");
  add_setting(command, "--seconds", bench.settings.seconds, "of each measurement (default 0.3)");
}

void add_nordland(Program& program, Bench<NordlandBenchSettings>& bench, std::string& train,
                  std::string& query) {
  const Command command = add_bench(
      program, bench, "nordland", "Long databases with c_l 300 (tab5, tab7).",
      "  vpr-bench nordland -o nordland.json\n"
      "  vpr-bench nordland --train summer.mp4 --query winter.mp4@0:1000 --databases 1000,10000",
      [&train, &query](Session& session, const NordlandBenchSettings& settings) {
        if (train.empty() != query.empty())
          throw Error(ErrorKind::usage, "give both --train and --query, or neither");
        std::optional<RecordedCodes> recorded;
        if (!train.empty())
          recorded = {describe(train, session.monitor), describe(query, session.monitor)};
        return bench_nordland(settings, recorded, session.options.seed, session.kernels,
                              session.monitor);
      });
  add_names(command, "--methods", bench.settings.methods,
            "of fastable-online, fastable, standardized, filter, openable, plain-fastable, "
            "plain-openable, lsh");
  add_numbers(command, "--databases", bench.settings.databases, "database sizes in frames");
  add_setting(command, "--c-l", bench.settings.window_length, "window length c_l (default 300)");
  add_setting(command, "--query-frames", bench.settings.query_frames,
              "of the query (default 1000)");
  add_setting(command, "--lsh-most-frames", bench.settings.lsh_most_frames,
              "longer databases are not hashed (default 100000)");
  add_setting(command, "--seconds", bench.settings.seconds, "of each measurement (default 1)");
  command.add_option("--train", train, "real frames instead of generated codes: the database");
  command.add_option("--query", query, "real frames instead of generated codes: the query");
}

void add_describe(Program& program, Bench<DescribeBenchSettings>& bench, std::string& images) {
  const Command command =
      add_bench(program, bench, "describe", "Decoding, LDB and every local feature, per frame.",
                "  vpr-bench describe --images walk -o describe.json",
                [&images](Session& session, const DescribeBenchSettings& settings) {
                  std::optional<Sequence> sequence;
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
  bool find_largest = false;
};

BenchResult run_realtime(Session& session, const RealtimeInputs& inputs,
                         const RealtimeBenchSettings& settings) {
  const Sequence query = open_sequence(parse_sequence_argument(inputs.query));
  BenchResult result;
  SequenceDatabase database;
  if (database_family(inputs.database) == DatabaseFamily::fabmap) {
    const FabmapDatabase places = read_fabmap_database(inputs.database);
    result = bench_realtime(query, fabmap_work(places, {}), settings, session.monitor);
  } else {
    database = read_sequence_database(inputs.database);
    if (settings.method == "filter") ensure_statistics(database, session.monitor);
    result = bench_realtime(query, sequence_work(database, settings, session.kernels), settings,
                            session.monitor);
  }
  const bool is_ldb = database.descriptors.kind == &descriptor_kinds().front();
  if (inputs.find_largest)
    find_largest_database(result, settings, session.kernels, session.options.seed,
                          is_ldb ? DescriptorRows() : database.descriptors.rows(), session.monitor);
  return result;
}

void add_realtime(Program& program, Bench<RealtimeBenchSettings>& bench, RealtimeInputs& inputs) {
  const Command command = add_bench(
      program, bench, "realtime", "Replay a recording at its rate: latency and missed deadlines.",
      "  vpr-bench realtime corridor.vprdb --query corridor/query --rate 10 --largest\n"
      "  vpr-bench realtime network.vprdb --query q.npy --rate 30",
      [&inputs](Session& session, const RealtimeBenchSettings& settings) {
        return run_realtime(session, inputs, settings);
      });
  command.add_option("DB", inputs.database, "database of either method").required();
  command
      .add_option("--query", inputs.query,
                  "folder or list of images; of a database of vpr-train descriptors, n x d numbers "
                  "or a folder with a .npy file a frame")
      .required();
  add_setting(command, "--method", bench.settings.method,
              "of a database of sequences: fastable (default) or filter")
      .choices("METHOD", {"fastable", "filter"});
  add_setting(command, "--rate", bench.settings.rate_hz, "frames a second (default 10)");
  add_setting(command, "--frames", bench.settings.frames, "of the query at most (default 100)");
  add_setting(command, "--c-l", bench.settings.window_length, "window length c_l (default 40)");
  add_names(command, "--rates", bench.settings.rates, "of windows (default 1)").type_name("P/Q");
  command.add_flag("--largest", inputs.find_largest,
                   "find the largest database that keeps the rate with --share of a core (of LDB "
                   "codes, or else of this database's descriptors again and again)");
  add_setting(command, "--share", bench.settings.share_percent,
              "per cent of one core (default 10)");
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program(
      "vpr-bench",
      "Measure times on this machine, checked before they are taken, on one core unless "
      "--threads says otherwise.",
      "  vpr-bench matching --databases 1000,8000 --c-l 20,80 -o matching.json");
  program.set_default_threads(1);
  Bench<MatchingBenchSettings> matching;
  add_matching(program, matching);
  Bench<NordlandBenchSettings> nordland;
  std::string train;
  std::string query;
  add_nordland(program, nordland, train, query);
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
