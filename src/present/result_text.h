// Lines about a result for a terminal: its settings, and the recognized ranges of its path.
#pragma once

#include <string>
#include <vector>

#include "query/result.h"

namespace vpr {

/// The settings in force on one line: "FastABLE, c_l 40, t_r 0.725 relative". The
/// thresholds and margins of automatic settings are those of the result.
std::string settings_text(const Result& result);

/// The name of the method for readers: filter, z-score windows, FastABLE, FAB-MAP; OpenABLE and LSH
/// are ways to compute FastABLE's windows.
std::string method_text(const QuerySettings& settings);

/// Whether the result can have recognitions: false for best matches without a threshold or margin.
bool has_rule(const Result& result);

/// A stretch of the query that is recognized along one stretch of a training sequence.
struct RecognizedRange {
  size_t query_first = 0;  ///< frame; the anchor of the first recognized window
  size_t query_last = 0;
  std::string train;                        ///< sequence and frames, "monday 66-139", or a place
  std::string score;                        ///< speed, "1.0x", or the probability of a place
  std::vector<uint32_t> recognitions = {};  ///< indices
  std::string verdict = {};  ///< ": 3 of 50 frames incorrect"; empty if nothing is incorrect
};

/// The clusters of a result, or the runs of its places, by first query frame.
std::vector<RecognizedRange> recognized_ranges(const Result& result);

/// "tuesday 64-137 = monday 66-139, 1.0x".
std::string range_text(const Result& result, const RecognizedRange& range);

/// One indented line per range with its verdict: the longest, then the longest with a verdict, then
/// the longest others, at most `most` in the order of the query, and the number of the others.
/// `noun`: of one of these.
std::string ranges_text(const Result& result, std::vector<RecognizedRange> ranges, size_t most,
                        const std::string& noun);

}  // namespace vpr
