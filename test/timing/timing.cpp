// Times the lines of the speed table that concern matching and description, on random codes:
//   vpr-timing [frames] [c_l] [query frames] [folder of images]
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "base/stopwatch.h"
#include "descriptors/describe.h"
#include "matching/fastable_batch.h"
#include "matching/fastable_online.h"
#include "matching/openable.h"
#include "matching/plain.h"
#include "recognition/clustering.h"

namespace {

using namespace vpr;

std::vector<LdbCode> random_codes(size_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<LdbCode> codes(count);
  for (LdbCode& code : codes) {
    for (uint8_t& byte : code) byte = static_cast<uint8_t>(engine());
    code[173] &= 3;
    code[174] = code[175] = 0;
  }
  return codes;
}

void report(const std::string& what, std::vector<double> ms, const std::string& unit = "ms") {
  fmt::print("{:<52} {:9.4f} {} (quartiles {:.4f} {:.4f})\n", what, median(ms), unit,
             quantile(ms, 0.25), quantile(ms, 0.75));
  std::fflush(stdout);
}

double online(const TrainCodes& train, const QueryCodes& query, const MatchSettings& settings,
              const std::string& name) {
  FastableState state = start_fastable(train, settings);
  std::vector<double> ms;
  for (size_t f = 0; f < query.words.size(); ++f) {
    const Stopwatch watch;
    advance_fastable(state, train, settings.kernels, query.words[f]);
    if (f > settings.window_length) ms.push_back(watch.elapsed_ms());
  }
  report(name, ms);
  return median(ms);
}

void time_matching(size_t frames, size_t length, size_t queries) {
  const std::vector<LdbCode> train_codes = random_codes(frames, 1);
  const std::vector<LdbCode> query_codes = random_codes(length + queries, 2);
  const CodeSpan span{train_codes, {}};
  const TrainCodes train = make_train_codes(std::span(&span, 1));
  const QueryCodes query = make_query_codes({query_codes, {}});
  MatchSettings settings{length, size_t{1} << 40, select_kernels()};
  fmt::print("{} frames, c_l {}, {} query windows, {}\n", frames, length, queries,
             settings.kernels.target);
  for (const size_t threads : {size_t{1}, size_t{2}}) {
    const ThreadLimit limit(threads);
    online(train, query, settings, fmt::format("online, ring, {} threads", threads));
    MatchSettings no_ring = settings;
    no_ring.memory_limit = 0;
    online(train, query, no_ring, fmt::format("online, no ring, {} threads", threads));
    std::vector<double> ms;
    for (int repeat = 0; repeat < 5; ++repeat) {
      const Stopwatch watch;
      match_fastable(train, query, settings, {}, [](const DistanceRow&) {});
      ms.push_back(watch.elapsed_ms() / static_cast<double>(query.words.size()));
    }
    report(fmt::format("batch per query frame, {} threads", threads), ms);
  }
  const ThreadLimit limit(1);
  const size_t rows = 3;  // of openable, which takes long
  const QueryCodes few = make_query_codes({std::span(query_codes).first(length + rows - 1), {}});
  Stopwatch watch;
  match_openable(train, few, settings, {}, [](const DistanceRow&) {});
  report("openable, same kernels, per query frame", {watch.elapsed_ms() / rows});
  watch = {};
  uint32_t sum = 0;
  for (size_t i = 0; i < frames; ++i)
    sum += plain_hamming(train_codes[i], query_codes[0]) -
           plain_hamming(train_codes[i], query_codes[1]);
  report("plain scalar fastable, per query frame", {watch.elapsed_ms()});
  if (sum == 1) fmt::print("\n");
}

void time_clustering() {
  RandomEngine engine(3);
  std::vector<Cell> hits;
  for (uint32_t q = 0; q < 10000; ++q)
    for (uint32_t t = 0; t < 400; ++t)
      if (engine() % 4 == 0) hits.push_back({q, 0, t, 1});
  const Stopwatch watch;
  const auto places = cluster_hits(hits, {});
  report(fmt::format("cluster {} hits into {} places", hits.size(), places.size()),
         {watch.elapsed_ms()});
}

void time_description() {
  cv::Mat frame(480, 640, CV_8UC1);
  cv::randu(frame, 0, 256);
  std::vector<double> ms;
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const Stopwatch watch;
    describe_ldb(frame);
    ms.push_back(watch.elapsed_ms());
  }
  report("describe a 640x480 frame", ms);
}

// Decoding alone against decoding and describing, in turn, on all cores.
void time_training(const std::string& folder) {
  const Sequence sequence = open_sequence({folder, {}});
  std::vector<double> decode_ms;
  std::vector<double> describe_ms;
  for (int repeat = 0; repeat < 5; ++repeat) {
    Stopwatch watch;
    for_each_frame(sequence, PixelFormat::grey, Unreadable::fail, {},
                   [](size_t, const cv::Mat&) {});
    decode_ms.push_back(watch.elapsed_ms());
    watch = {};
    describe_sequence(sequence, {}, Unreadable::fail, {});
    describe_ms.push_back(watch.elapsed_ms());
  }
  report(fmt::format("decode {} files", sequence.files.size()), decode_ms);
  report("decode and describe them", describe_ms);
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i, size_t otherwise) {
    return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
  };
  cv::setNumThreads(1);
  time_description();
  time_clustering();
  if (argc > 4) time_training(argv[4]);
  time_matching(argument(1, 100'000), argument(2, 300), argument(3, 200));
  return 0;
}
