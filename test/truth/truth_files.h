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
#include "truth/builder.h"
#include "truth/formats.h"
#include "truth/ground_truth.h"

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

struct Files {
  test::TemporaryFolder folder;

  std::string read(GroundTruthArgument argument, size_t query, size_t train) const {
    argument.path = folder / argument.path.string();
    if (!argument.options.reference.empty())
      argument.options.reference = folder / argument.options.reference.string();
    if (!argument.options.soft.empty())
      argument.options.soft = folder / argument.options.soft.string();
    return draw(read_ground_truth(argument, {{"", query}, {{"ref", train}}}), query, train);
  }
  std::string read(const std::string& name, size_t query, size_t train) const {
    return read(GroundTruthArgument{"", name}, query, train);
  }
  void text(const std::string& name, const std::string& content) const {
    test::write_text(folder / name, content);
  }
  template <class T>
  void matrix(const std::string& name, const std::vector<T>& values, size_t rows, size_t cols,
              std::string_view type) const {
    Outputs outputs(Existing::replace);
    Output& file = outputs.file(folder / name);
    file.write(npy_header(type, {rows, cols}));
    file.write(std::as_bytes(std::span<const T>(values)));
    outputs.commit();
  }
};

inline void write_truth(const GroundTruthFormat& format, const InspectedGroundTruth& truth,
                        const std::filesystem::path& path) {
  Outputs outputs(Existing::replace);
  format.write(truth, outputs.file(path), {});
  outputs.commit();
}

}  // namespace vpr::test
