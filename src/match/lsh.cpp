#include "match/lsh.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>

#include <opencv2/core/hal/hal.hpp>
#include <opencv2/flann.hpp>

#include "base/error.h"
#include "base/parallel.h"

namespace vpr {
namespace {

constexpr uint64_t kMostKeyBits = 28;

/// The differing bits of two windows, by OpenCV's kernel for this processor.
struct WindowHamming {
  using ElementType = unsigned char;
  using ResultType = int;
  using CentersType = unsigned char;
  using is_kdtree_distance = cvflann::False;
  using is_vector_space_distance = cvflann::False;

  int operator()(const unsigned char* a, const unsigned char* b, size_t bytes, int = -1) const {
    return cv::hal::normHamming(a, b, static_cast<int>(bytes));
  }
};

/// Collects the contents of buckets, with duplicates from several tables.
class Collector : public cvflann::ResultSet<int> {
 public:
  bool full() const override { return false; }
  void addPoint(int distance, int index) override { found.emplace_back(index, distance); }
  int worstDist() const override { return std::numeric_limits<int>::max(); }

  std::vector<std::pair<int, int>> found;
};

// About one window in eight buckets: log2 of the number of windows, plus three.
uint64_t key_bits(const LshSettings& settings, size_t windows) {
  if (settings.key_bits != 0) return settings.key_bits;
  return std::clamp<uint64_t>(std::bit_width(windows) + 2, 4, kMostKeyBits);
}

/// The tables of one run of frames.
struct Tables {
  FrameStretch run;
  cvflann::LshIndex<WindowHamming> index;

  // OpenCV expects non-const data, but does not change it.
  Tables(const FrameStretch& frames, const DescriptorRows& rows, size_t window_length,
         const LshSettings& settings)
      : run(frames),
        index(cvflann::Matrix<unsigned char>(
                  const_cast<unsigned char*>(rows[frames.first_in_sequence].data()),
                  frames.windows(window_length), window_length * rows.shape.row_bytes(),
                  rows.shape.row_bytes()),
              cvflann::LshIndexParams(
                  static_cast<int>(settings.tables),
                  static_cast<int>(key_bits(settings, frames.windows(window_length))),
                  static_cast<int>(settings.probe_level))) {}
};

// Frames whose rows are one after the other, in `bytes`: windows are strings of bits.
DescribedFrames packed(DescribedFrames frames, std::vector<uint8_t>& bytes) {
  for (size_t i = 0; i < frames.rows.size(); ++i)
    bytes.insert(bytes.end(), frames.rows[i].begin(), frames.rows[i].end());
  frames.rows = {frames.rows.shape, bytes};
  return frames;
}

}  // namespace

LshSearch make_lsh_search(std::span<const DescribedFrames> train, size_t window_length,
                          const LshSettings& settings, uint64_t seed, const Monitor& monitor) {
  require_range("lsh.tables", static_cast<double>(settings.tables), 1, 256);
  require_range("lsh.key_bits", static_cast<double>(settings.key_bits), 0, kMostKeyBits);
  require_range("lsh.probe_level", static_cast<double>(settings.probe_level), 0, 4);
  std::vector<std::shared_ptr<Tables>> by_run;
  for (const FrameStretch& run : readable_runs(train))
    if (run.windows(window_length) > 0)
      by_run.push_back(
          std::make_shared<Tables>(run, train[run.sequence].rows, window_length, settings));
  StepCounter counter(monitor, "index", by_run.size());
  parallel_for(by_run.size(), monitor, [&](size_t i) {
    cv::setRNGSeed(static_cast<int>(seed + i));  // of this thread
    by_run[i]->index.buildIndex();
    counter.add();
  });
  return [by_run](const uint8_t* window) {
    std::vector<Cell> cells;
    for (const auto& tables : by_run) {
      Collector collector;
      tables->index.findNeighbors(collector, window, cvflann::SearchParams());
      auto& found = collector.found;
      std::sort(found.begin(), found.end());
      found.erase(std::unique(found.begin(), found.end()), found.end());
      const FrameStretch& run = tables->run;
      for (const auto& [index, distance] : found)
        cells.push_back({0, static_cast<uint32_t>(run.sequence),
                         static_cast<uint32_t>(run.first_in_sequence + static_cast<size_t>(index)),
                         static_cast<uint32_t>(distance)});
    }
    return cells;
  };
}

void match_lsh(const FrameDistances& distances, const MatchSettings& settings,
               const Monitor& monitor, const RowConsumer& consume) {
  const DescriptorRows& query = distances.query.rows;
  if (query.stride != query.shape.row_bytes()) {
    FrameDistances contiguous = distances;
    std::vector<std::vector<uint8_t>> bytes(distances.train.size() + 1);
    contiguous.query = packed(distances.query, bytes.back());
    for (size_t t = 0; t < distances.train.size(); ++t)
      contiguous.train[t] = packed(distances.train[t], bytes[t]);
    return match_lsh(contiguous, settings, monitor, consume);
  }
  if (query.shape.element != ElementType::bits || distances.is_in_order())
    throw Error(ErrorKind::usage, "lsh needs raw distances of binary descriptors; use fastable");
  const size_t length = settings.window_length;
  std::vector<DescribedFrames> searched(distances.train.size());
  for (const FrameStretch& run : distances.train_runs)
    searched[run.sequence] = distances.train[run.sequence];
  const LshSearch find = make_lsh_search(searched, length, settings.lsh, settings.seed, monitor);
  StepCounter counter(monitor, "match", distances.query_frames);
  parallel_for(distances.query_frames, monitor, [&](size_t query_end) {
    if (ends_window(distances, length, query_end)) {
      const size_t window = query_end + 1 - length;
      for (const Cell& cell : find(query[window].data()))
        consume({window, cell.sequence, cell.train_window, {&cell.score, 1}});
    }
    counter.add();
  });
}

}  // namespace vpr
