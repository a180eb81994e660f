#include "ground_truth/mask_image.h"

#include <array>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/counted.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "ground_truth/builder.h"
#include "ground_truth/label_runs.h"
#include "ground_truth/matrix_shape.h"
#include "ground_truth/writing.h"
#include "images/decode.h"

namespace vpr {
namespace {

constexpr uint8_t kSame = 255;
constexpr uint8_t kIgnored = 128;
constexpr size_t kLargestSide = size_t{1} << 20;  // OpenCV's

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8"); }

bool is_lossless_image(std::string_view bytes) {
  constexpr std::array<std::string_view, 8> kMagic = {"\x89PNG", "BM",  "P5\n", "P2\n",
                                                      "P5 ",     "P2 ", "II*",  "MM"};
  for (const std::string_view magic : kMagic)
    if (bytes.starts_with(magic)) return true;
  return false;
}

// What can't be decoded is damage here, not a frame that is missing.
cv::Mat decode_mask(const GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  const MappedFile file(path);
  if (is_jpeg(file.text()))
    builder.fail("is a JPEG, whose grey values are not what was drawn; save it as PNG");
  try {
    return decode_image(path, PixelFormat::grey);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    builder.fail("is no image that can be decoded");
  }
}

}  // namespace

bool is_mask_image(const FileStart& start) {
  return is_jpeg(start.bytes) || is_lossless_image(start.bytes);
}

std::string read_mask_image(GroundTruthBuilder& builder) {
  const size_t sequence = builder.only_searched(builder.argument().path.string());
  const cv::Mat mask = decode_mask(builder);
  const bool rows_are_query = require_matrix_shape(
      builder, sequence, static_cast<size_t>(mask.rows), static_cast<size_t>(mask.cols), true);
  for (int r = 0; r < mask.rows; ++r) {
    builder.check_stop();
    for (int c = 0; c < mask.cols; ++c) {
      const uint8_t value = mask.at<uint8_t>(r, c);
      if (value == 0) continue;
      const auto query = static_cast<size_t>(rows_are_query ? r : c);
      const auto reference = static_cast<size_t>(rows_are_query ? c : r);
      builder.add(query, sequence, reference, reference,
                  value == kSame ? PlaceLabel::same : PlaceLabel::ignore);
    }
  }
  return fmt::format("mask image, rows are {} frames; grey is ignored; within {} of white",
                     rows_are_query ? "query" : "training",
                     counted(static_cast<uint64_t>(builder.argument().tolerance_frames), "frame"));
}

void write_mask_image(const InspectedGroundTruth& ground_truth, OutputFile& file,
                      const Monitor& monitor) {
  const size_t sequence = only_written_sequence(ground_truth, "mask");
  const size_t rows = ground_truth.truth.pairs.size();
  const size_t cols = ground_truth.scope.sequences[sequence].frames;
  if (rows == 0 || cols == 0 || rows > kLargestSide || cols > kLargestSide)
    throw Error(ErrorKind::usage,
                fmt::format("a picture of {} x {} pixels can't be written", rows, cols));
  cv::Mat mask = cv::Mat::zeros(static_cast<int>(rows), static_cast<int>(cols), CV_8U);
  for (size_t query = 0; query < rows; ++query) {
    check_stop(monitor);
    for (const LabelRun& run : label_runs(ground_truth.truth, query, sequence, cols))
      mask.row(static_cast<int>(query))
          .colRange(static_cast<int>(run.first), static_cast<int>(run.last) + 1)
          .setTo(run.label == PlaceLabel::same ? kSame : kIgnored);
  }
  std::vector<uint8_t> png;
  cv::imencode(".png", mask, png);
  file.write(std::as_bytes(std::span<const uint8_t>(png)));
}

}  // namespace vpr
