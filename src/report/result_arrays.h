// The arrays beside a result file, as the reader takes them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "recognition/result.h"
#include "report/json_fields.h"

namespace vpr {

/// A result file that is being read.
struct ResultSource {
  const std::filesystem::path& path;
  const std::string& where;
  const Fields& fields;
};

/// What a sum over a window, as rows of matchers hold it, is above the score that files hold; 0
/// where scores are no sums.
int64_t offset_of(const Result& result);

/// Windows that fit in `frames` frames.
uint64_t window_count(uint64_t frames, uint64_t window_length);

/// Each of these reads into the result, whose query and targets are known, and throws Error(data)
/// for an array that is another one, damaged or out of range: hits and best matches, rates of best
/// matches where there are several, their margins and where views begin (where known), what the
/// filter says of query frames, probabilities of a new place, and the frames that a replay shows,
/// or that are kept of training sequences.
void read_matches(const ResultSource& source, Result& result);
void read_rates(const ResultSource& source, Result& result);
void read_margins(const ResultSource& source, Result& result);
void read_path(const ResultSource& source, Result& result);
void read_views(const ResultSource& source, Result& result);
void read_replay(const ResultSource& source, Result& result);
void read_kept(const ResultSource& source, Result& result);
void read_new_place(const ResultSource& source, Result& result);

}  // namespace vpr
