// Small ground truth files and their labels as text.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "base/npy.h"
#include "base/output.h"
#include "support.h"
#include "truth/formats.h"
#include "truth/ground_truth.h"
#include "truth/readers.h"

namespace vpr::test {

/// The labels of a ground truth, one character per pair: . different, S same, i ignored.
inline std::string draw(const GroundTruth& truth, size_t query_frames, size_t train_frames) {
  std::string text;
  for (size_t q = 0; q < query_frames; ++q) {
    std::vector<PlaceLabel> row(train_frames);
    truth.label_row(q, 0, row);
    for (size_t r = 0; r < train_frames; ++r) {
      CHECK(truth.label(q, 0, r) == row[r]);
      text += ".Si"[static_cast<size_t>(row[r])];
    }
    if (q + 1 < query_frames) text += ' ';
  }
  return text;
}

/// The labels of a ground truth of one training sequence.
inline std::string read_labels(const GroundTruthArgument& argument, size_t query, size_t train) {
  return draw(read_ground_truth(argument, {{"", query}, {{"ref", train}}}), query, train);
}
inline std::string read_labels(const std::string& name, size_t query, size_t train) {
  return read_labels(GroundTruthArgument{"", name}, query, train);
}

/// Ground truth by the positions of two files, of a detected format.
inline GroundTruthArgument by_positions(const std::string& query, const std::string& train,
                                        std::optional<double> radius_m) {
  GroundTruthArgument argument{"", query};
  argument.options.reference = train;
  argument.options.radius_m = radius_m;
  return argument;
}

/// Requires an error of this kind whose message has these words.
template <class Work>
void check_refused(Work&& work, std::string_view words, ErrorKind kind = ErrorKind::data) {
  CHECK(error_kind(work) == kind);
  const std::string text = error_text(work);
  INFO(text);
  CHECK(has(text, words));
}

template <class T>
void write_matrix(const std::string& name, const std::vector<T>& values, size_t rows, size_t cols,
                  std::string_view type) {
  Outputs outputs(Existing::replace);
  Output& file = outputs.file(name);
  file.write(npy_header(type, {rows, cols}));
  file.write(std::as_bytes(std::span<const T>(values)));
  outputs.commit();
}

inline void write_truth(const GroundTruthFormat& format, const InspectedGroundTruth& truth,
                        const std::filesystem::path& path) {
  Outputs outputs(Existing::replace);
  format.write(truth, outputs.file(path), {});
  outputs.commit();
}

}  // namespace vpr::test
