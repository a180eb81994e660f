#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "bench/benches.h"
#include "bench/generated.h"
#include "fabmap/model.h"
#include "fabmap/word_clustering.h"

namespace vpr {
namespace {

constexpr size_t kQueries = 20;
// Views, pretraining frames and queries have separate seeds.
constexpr uint64_t kPretrainSeed = uint64_t{1} << 40;
constexpr uint64_t kQuerySeed = uint64_t{2} << 40;
constexpr size_t kCheckedPlaces = 100;

void check_fabmap_settings(const FabmapBenchSettings& settings) {
  check_values("place_counts", settings.place_counts, 1, 100'000'000);
  check_values("words", settings.words, 2, 10'000'000);
  check_values("words_per_frame", settings.words_per_frame, 1, 100'000);
  check_values("descriptors", {settings.descriptors}, 0, 100'000'000);
  check_values("pretrain_frames", {settings.pretrain_frames}, 1, 1'000'000);
  check_seconds(settings.seconds);
  require_range("frame_ms", settings.frame_ms, 0, 3'600'000);
  for (const std::string& variant : settings.variants) find_fabmap_variant(variant);
}

ViewWords generate_views(size_t words, size_t places, size_t per_frame, uint64_t seed) {
  ViewWords views;
  for (size_t v = 0; v < places; ++v) views.add(generate_words(words, per_frame, seed + v));
  return views;
}

/// Views with the data that queries need.
struct Example {
  ViewWords views;
  WordIndex lists;
  FabmapIndex index;
  std::vector<WordSet> queries;

  Example(const FabmapModel& model, size_t places, size_t per_frame, uint64_t seed)
      : views(generate_views(model.words(), places, per_frame, seed)),
        lists(make_word_index(views, model.words())),
        index(make_fabmap_index(model, views, lists)) {
    for (size_t q = 0; q < kQueries; ++q)
      queries.push_back(generate_words(model.words(), per_frame, seed + kQuerySeed + q));
  }
  Example(const Example&) = delete;

  FabmapQuery query(const FabmapModel& model, const WordSet& words) const {
    return {model, views, index, words, views.views()};
  }
  FabmapQuery query(const FabmapModel& model, size_t q) const {
    return query(model, queries[q % queries.size()]);
  }
  // Entries in the lists that a query visits: the work of the inverted index.
  double postings(const FabmapModel& model) const {
    size_t sum = 0;
    for (const WordSet& query : queries) {
      std::vector<uint8_t> touched = word_flags(query, model.words());
      for (const uint32_t word : query)
        for (const uint32_t child : model.children[word]) touched[child] = 1;
      for (size_t block = 0; block < lists.blocks(); ++block)
        for (size_t word = 0; word < model.words(); ++word)
          if (touched[word] != 0) sum += lists.list(block, word).size();
    }
    return static_cast<double>(sum) / static_cast<double>(queries.size());
  }
};

// The maximum error of a variant: its documented error plus rounding.
double stated_error(const std::string& variant, size_t words) {
  if (variant == "lut") return 0.5e-6 * static_cast<double>(words) + 1e-9;
  return 1e-9 * static_cast<double>(words) / 1000 + 1e-9;  // sums of many terms
}

void check_variants(const FabmapModel& model, const FabmapBenchSettings& settings, size_t per_frame,
                    uint64_t seed) {
  const Example example(model, kCheckedPlaces, per_frame, seed);
  for (size_t q = 0; q < 3; ++q) {
    const FabmapQuery query = example.query(model, q);
    const auto expected = fabmap1_log_likelihoods(query);
    const double best = *std::max_element(expected.begin(), expected.end());
    for (const std::string& variant : settings.variants) {
      const auto found = find_fabmap_variant(variant).log_likelihoods(query);
      for (size_t v = 0; v < found.size(); ++v) {
        // For dropped views, fast bail-out only states that they cannot win.
        if (variant == "fbo" && expected[v] < best - 5) continue;
        if (std::abs(found[v] - expected[v]) > stated_error(variant, model.words()))
          throw Error(ErrorKind::expectation,
                      "{}: a log-likelihood differs from the reference implementation by more than "
                      "documented; nothing was timed",
                      variant);
      }
    }
  }
}

// Uniformly distributed values: nothing converges early, so this is the slowest case.
BenchRow time_kmeans(const FabmapBenchSettings& settings, uint64_t words, uint64_t seed,
                     const Monitor& monitor) {
  RandomEngine engine(seed);
  cv::Mat descriptors(static_cast<int>(settings.descriptors), 64, CV_32F);
  for (int r = 0; r < descriptors.rows; ++r)
    for (int c = 0; c < descriptors.cols; ++c)
      descriptors.at<float>(r, c) = static_cast<float>(uniform_unit(engine));
  const Stopwatch watch;
  kmeans_words(descriptors, {words, settings.iterations, seed}, monitor);
  return {"k-means",
          {{"descriptors", settings.descriptors},
           {"words", words},
           {"iterations", settings.iterations}},
          "vocabulary",
          summarize({watch.elapsed_ms()})};
}

// Times the Chow-Liu tree of generated frames; returns the tree.
ChowLiuTree time_tree(BenchResult& result, const FabmapBenchSettings& settings, uint64_t words,
                      uint64_t per_frame, uint64_t seed, const Monitor& monitor) {
  std::vector<WordSet> frames;
  for (size_t f = 0; f < settings.pretrain_frames; ++f)
    frames.push_back(generate_words(words, per_frame, seed + kPretrainSeed + f));
  const Stopwatch watch;
  ChowLiuTree tree = train_chow_liu(frames, words, monitor);
  result.rows.push_back({"chow-liu tree",
                         {{"pretrain_frames", settings.pretrain_frames},
                          {"words", words},
                          {"words_per_frame", per_frame}},
                         "tree",
                         summarize({watch.elapsed_ms()})});
  return tree;
}

bool is_slow(const std::string& variant) { return variant != "fabmap2"; }

// Times the likelihoods of all places with every variant, the new place (mean over the pretraining
// frames) and the posterior, and the whole query as vpr-query computes it by default.
void time_queries(BenchResult& result, const FabmapBenchSettings& settings,
                  const FabmapModel& model, const Example& example, const Example& pretrain,
                  const NamedNumbers& parameters, const Monitor& monitor) {
  const Effort effort{settings.seconds};
  const size_t places = example.views.views();
  const double postings = example.postings(model);
  for (const std::string& variant : settings.variants) {
    if (is_slow(variant) &&
        static_cast<double>(places) * static_cast<double>(model.words()) > settings.slow_limit) {
      result.left_out.push_back(
          fmt::format("{} with {} places: above slow_limit", variant, places));
      continue;
    }
    const auto& log_likelihoods = find_fabmap_variant(variant).log_likelihoods;
    size_t q = 0;
    const auto query = [&] { log_likelihoods(example.query(model, q++)); };
    BenchRow row{variant, parameters, "query frame", time_repeatedly(effort, query, monitor)};
    row.values.emplace_back("fps", 1000 / (settings.frame_ms + row.time.median_ms));
    if (!is_slow(variant)) row.values.emplace_back("postings", postings);
    result.rows.push_back(std::move(row));
  }
  const auto add_row = [&](const char* work, const std::function<void()>& timed,
                           const std::string& note) {
    BenchRow row{work, parameters, "query frame", time_repeatedly(effort, timed, monitor)};
    row.note = note;
    result.rows.push_back(std::move(row));
  };
  const auto new_place = [&](size_t q) {
    const WordSet& words = example.queries[q % example.queries.size()];
    return log_mean_exp(fabmap2_log_likelihoods(pretrain.query(model, words)));
  };
  const auto logs = fabmap2_log_likelihoods(example.query(model, 0));
  size_t q = 0;
  add_row(
      "posterior", [&] { fabmap_posterior(logs, logs[0], {}, {}); }, "");
  add_row(
      "new place", [&] { new_place(q++); },
      fmt::format("{} pretraining frames", pretrain.views.views()));
  add_row(
      "query",
      [&] {
        const auto views = fabmap2_log_likelihoods(example.query(model, q));
        fabmap_posterior(views, new_place(q), {}, {});
        ++q;
      },
      "fabmap2, new place, posterior");
}

}  // namespace

BenchResult bench_fabmap(const FabmapBenchSettings& settings, uint64_t seed,
                         const Monitor& monitor) {
  check_fabmap_settings(settings);
  BenchResult result{"fabmap", value_to_json(settings)};
  StepCounter counter(
      monitor, "measure",
      settings.words.size() * settings.words_per_frame.size() * settings.place_counts.size());
  for (const uint64_t words : settings.words) {
    if (settings.descriptors >= words)
      result.rows.push_back(time_kmeans(settings, words, seed, monitor));
    for (const uint64_t per_frame : settings.words_per_frame) {
      const ChowLiuTree tree = time_tree(result, settings, words, per_frame, seed, monitor);
      const FabmapModel model = make_fabmap_model(tree, {}, WordModel::tree);
      check_variants(model, settings, per_frame, seed);
      const Example pretrain(model, settings.pretrain_frames, per_frame, seed + kPretrainSeed);
      for (const uint64_t places : settings.place_counts) {
        const Example example(model, places, per_frame, seed);
        time_queries(result, settings, model, example, pretrain,
                     {{"places", places}, {"words", words}, {"words_per_frame", per_frame}},
                     monitor);
        counter.add();
      }
    }
  }
  const uint64_t words = settings.words.front();
  const uint64_t per_frame = settings.words_per_frame.front();
  Chart chart{"fabmap",
              fmt::format("FAB-MAP query time, {} words, {} per frame", words, per_frame),
              {"places", true},
              {"milliseconds", true},
              time_series(result, settings.variants, "places",
                          {{"words", words}, {"words_per_frame", per_frame}})};
  result.charts.push_back(chart);
  chart.file = "fabmap-fps";
  chart.title = fmt::format("FAB-MAP: most frames per second, {:g} ms of features per frame",
                            settings.frame_ms);
  chart.y = {.label = "frames per second", .from_zero = true};
  for (Series& series : chart.series)
    for (auto& point : series.points) point.second = 1000 / (settings.frame_ms + point.second);
  result.charts.push_back(std::move(chart));
  return result;
}

}  // namespace vpr
