#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/converters.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/npy.h"
#include "base/output.h"
#include "base/text.h"
#include "base/zip_file.h"
#include "truth/readers.h"

namespace vpr {

namespace {

constexpr std::string_view kHard = "GThard.npy";
constexpr std::string_view kSoft = "GTsoft.npy";
constexpr uint64_t kMaxValues = 10'000'000'000;
constexpr uint64_t kMaxArchiveValues = uint64_t{1} << 31;  // the values are in memory

// An archive starts with its first file, or with its directory if it is empty.
bool is_zip(std::string_view bytes) {
  return bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06");
}

std::optional<size_t> find_entry(const ZipFile& archive, std::string_view name) {
  const auto found = std::ranges::find(archive.names(), name);
  if (found == archive.names().end()) return std::nullopt;
  return static_cast<size_t>(found - archive.names().begin());
}

/// Writes the next bytes of a file and returns their number, 0 at the end.
using Fill = std::function<size_t(std::span<std::byte>)>;

Fill fill_from(const std::filesystem::path& path) {
  return [file = std::make_shared<MappedFile>(path),
          at = size_t{0}](std::span<std::byte> bytes) mutable {
    const size_t count = std::min(bytes.size(), file->bytes().size() - at);
    std::copy_n(file->bytes().begin() + static_cast<ptrdiff_t>(at), count, bytes.begin());
    at += count;
    return count;
  };
}

/// Reads a matrix row by row in the order of the file: columns for a Fortran-ordered matrix.
class NpyStream {
 public:
  /// `name`: the file in errors. Throws Error(data) if it is not a matrix of numbers.
  NpyStream(const std::string& name, Fill fill) : location_{name}, fill_(std::move(fill)) {
    std::vector<std::byte> start(kMaxNpyHeader);
    start.resize(read_some(start));
    start_ = std::move(start);
    const auto header =
        parse_npy_header({reinterpret_cast<const char*>(start_.data()), start_.size()});
    type_ = &number_type_of(name, header);
    if (header->shape.size() != 2)
      location_.fail("expected a matrix of 0 and 1, query x training frames; found the shape ({})",
                     fmt::join(header->shape, ", "));
    header_ = *header;
    used_ = header_.offset;
  }

  const std::vector<size_t>& shape() const { return header_.shape; }
  size_t rows() const { return header_.shape[header_.is_column_major ? 1 : 0]; }
  size_t cols() const { return header_.shape[header_.is_column_major ? 0 : 1]; }
  /// Whether the rows in the file are columns of the matrix.
  bool is_transposed() const { return header_.is_column_major; }

  /// Writes the values of the next row, 0 or 1. Throws Error(data) for other values or if the file
  /// ends early.
  void next_row(std::span<uint8_t> values) {
    row_.resize(cols() * type_->bytes);
    numbers_.resize(cols());
    if (read_some(row_) < row_.size())
      location_.fail("ends early; the file is truncated or damaged");
    location_.at("row", row_number_++);
    try {
      type_->read(row_.data(), type_->bytes, cols(), numbers_.data(), 1);
    } catch (const Error&) {  // an integer that double cannot represent
      location_.fail("has values other than 0 and 1; check that it is a ground truth");
    }
    for (size_t i = 0; i < cols(); ++i) {
      if (numbers_[i] != 0 && numbers_[i] != 1)
        location_.fail("column {} is neither 0 nor 1; check that it is a ground truth", i);
      values[i] = numbers_[i] != 0 ? 1 : 0;
    }
  }

  /// Throws Error(data) if there are more bytes.
  void require_end() {
    std::byte more{};
    location_.at({}, 0);
    if (read_some({&more, 1}) != 0) location_.fail("is longer than its shape");
  }

 private:
  // Fills `bytes` as far as the file reaches. Returns the number of bytes.
  size_t read_some(std::span<std::byte> bytes) {
    size_t done = std::min(bytes.size(), start_.size() - used_);
    std::copy_n(start_.begin() + static_cast<ptrdiff_t>(used_), done, bytes.begin());
    used_ += done;
    while (done < bytes.size()) {
      const size_t count = fill_(bytes.subspan(done));
      if (count == 0) break;
      done += count;
    }
    return done;
  }

  FileLocation location_;
  Fill fill_;
  std::vector<std::byte> start_;  ///< the part of the file that was read with the header
  size_t used_ = 0;               ///< bytes of `start_`
  NpyHeader header_;
  const NumberType* type_ = nullptr;
  std::vector<std::byte> row_;
  std::vector<double> numbers_;
  size_t row_number_ = 0;
};

// Whether the rows are query frames: as the argument's matrix_rows states; otherwise `usually`,
// unless only the transposed shape fits the numbers of frames. Throws Error(data) if neither fits.
bool require_matrix_shape(GroundTruthBuilder& builder, size_t sequence, size_t rows, size_t cols,
                          bool usually) {
  const FrameCount& query = builder.query();
  const FrameCount& train = builder.train(sequence);
  const auto fits = [](const FrameCount& side, size_t frames) {
    return side.grows || side.frames == frames;
  };
  const bool fits_query = fits(query, rows) && fits(train, cols);
  const bool fits_reference = fits(query, cols) && fits(train, rows);
  const MatrixRows stated = builder.argument().options.matrix_rows;
  bool rows_are_query = usually ? fits_query || !fits_reference : fits_query && !fits_reference;
  if (stated != MatrixRows::automatic) rows_are_query = stated == MatrixRows::query;
  if (!(rows_are_query ? fits_query : fits_reference))
    builder.fail(
        "is a matrix of {} x {}, but there are {} query and {} training frames{}", rows, cols,
        query.frames, train.frames,
        cols == 2 ? ". Save pairs as CSV with the header query,reference"
        : rows == query.frames && cols < train.frames
            ? ". If it lists the matches of each query, as for GSV-Cities, convert it with "
              "scripts/convert/vpr_bench.py"
            : "");
  builder.require_query_frames(rows_are_query ? rows : cols);
  builder.require_train_frames(sequence, rows_are_query ? cols : rows);
  return rows_are_query;
}

// `usually_query`: whether the rows of this kind of file are query frames by default.
std::string read_streams(GroundTruthBuilder& builder, NpyStream hard, std::optional<NpyStream> soft,
                         bool usually_query) {
  const size_t sequence = builder.only_searched(builder.argument().path.string());
  if (soft && (hard.shape() != soft->shape() || hard.is_transposed() != soft->is_transposed()))
    builder.fail("the soft matrix has another shape or order than the hard one");
  const bool rows_are_query =
      require_matrix_shape(builder, sequence, hard.shape()[0], hard.shape()[1], usually_query);
  const bool stored_rows_are_query = rows_are_query != hard.is_transposed();
  std::vector<uint8_t> same(hard.cols());
  std::vector<uint8_t> near(hard.cols());
  for (size_t r = 0; r < hard.rows(); ++r) {
    builder.check_stop();
    hard.next_row(same);
    if (soft) soft->next_row(near);
    for (size_t c = 0; c < same.size(); ++c) {
      if (same[c] == 0 && near[c] == 0) continue;
      const size_t reference = stored_rows_are_query ? c : r;
      builder.add(stored_rows_are_query ? r : c, sequence, reference, reference,
                  same[c] != 0 ? PlaceLabel::same : PlaceLabel::ignore);
    }
  }
  hard.require_end();
  if (soft) soft->require_end();
  return fmt::format("matrix of {} x {}, rows are {} frames{}; within {} of a 1", hard.shape()[0],
                     hard.shape()[1], rows_are_query ? "query" : "training",
                     soft ? "; pairs only in the soft matrix are ignored" : "",
                     counted(static_cast<uint64_t>(builder.argument().tolerance_frames), "frame"));
}

std::string read_archive(GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  ZipFile archive(path);
  const auto open = [&](size_t index) {
    const auto entry = std::make_shared<ZipFile::Entry>(archive, index);
    return NpyStream(path.string() + ", " + archive.names()[index],
                     [entry](std::span<std::byte> bytes) { return entry->read(bytes); });
  };
  if (!builder.argument().options.soft.empty())
    throw Error(ErrorKind::usage, "{}: a .npz file contains its soft matrix, named GTsoft",
                path.string());
  if (archive.names().empty()) builder.fail("is an archive without a matrix");
  const auto hard = find_entry(archive, kHard);
  if (!hard && archive.names().size() == 1) return read_streams(builder, open(0), {}, true);
  if (!hard)
    builder.fail("expected the matrices GThard and GTsoft, found {}",
                 fmt::join(archive.names(), ", "));
  NpyStream hard_stream = open(*hard);
  std::optional<NpyStream> soft;
  if (const auto index = find_entry(archive, kSoft)) soft = open(*index);
  return read_streams(builder, std::move(hard_stream), std::move(soft), false);
}

// A .npy file with training frames as rows. The values are 1 for a code of at least `least_code`;
// `codes` must outlive the result.
ZipContent matrix_content(std::string_view name, const std::string& header,
                          const std::vector<uint8_t>& codes, uint8_t least_code) {
  return {std::string(name),
          [&codes, header, least_code, at = size_t{0}](std::span<std::byte> bytes) mutable {
            const size_t count = std::min(bytes.size(), header.size() + codes.size() - at);
            for (size_t i = 0; i < count; ++i, ++at)
              bytes[i] = at < header.size() ? static_cast<std::byte>(header[at])
                                            : std::byte{codes[at - header.size()] >= least_code};
            return count;
          }};
}

void write_archive(const GroundTruth& truth, size_t sequence, size_t frames, Output& file,
                   const Monitor& monitor) {
  constexpr uint8_t kIgnore = 1;
  constexpr uint8_t kSame = 2;
  const size_t queries = truth.pairs.size();
  std::vector<uint8_t> codes(frames * queries);  // by training frame
  for (size_t query = 0; query < queries; ++query) {
    check_stop(monitor);
    for (const LabelStretch& run : label_runs(truth, query, sequence, frames))
      for (size_t frame = run.first; frame <= run.last; ++frame)
        codes[frame * queries + query] = run.label == PlaceLabel::same ? kSame : kIgnore;
  }
  const std::string header = npy_header("|b1", {frames, queries});
  file.write(zip_archive({matrix_content(kHard, header, codes, kSame),
                          matrix_content(kSoft, header, codes, kIgnore)}));
}

}  // namespace

bool is_matrix_file(const FileStart& start) {
  return start.bytes.starts_with("\x93NUMPY") || is_zip(start.bytes);
}

std::string read_matrix_file(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  const MappedFile file(argument.path);
  if (is_zip(file.text())) return read_archive(builder);
  refuse_convertible(argument.path, file.text().substr(0, kMaxNpyHeader));
  const auto open = [](const std::filesystem::path& path) {
    return NpyStream(path.string(), fill_from(path));
  };
  NpyStream hard = open(argument.path);
  std::optional<NpyStream> soft;
  if (!argument.options.soft.empty()) soft = open(argument.options.soft);
  return read_streams(builder, std::move(hard), std::move(soft), true);
}

void write_matrix_file(const InspectedGroundTruth& ground_truth, Output& file,
                       const Monitor& monitor) {
  const size_t sequence = only_searched_sequence(ground_truth.scope, "the format matrix");
  const size_t frames = ground_truth.scope.sequences[sequence].sequence.frames;
  const GroundTruth& truth = ground_truth.truth;
  const bool is_archive = file.path().extension() == ".npz";
  require_writable(uint64_t{truth.pairs.size()} * frames,
                   is_archive ? kMaxArchiveValues : kMaxValues, "values of a matrix");
  if (is_archive) return write_archive(truth, sequence, frames, file, monitor);
  file.write(npy_header("|b1", {truth.pairs.size(), frames}));
  std::vector<uint8_t> row(frames);
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    std::ranges::fill(row, 0);
    for (const LabelStretch& run : label_runs(truth, query, sequence, frames))
      if (run.label == PlaceLabel::same)
        std::fill_n(row.begin() + static_cast<ptrdiff_t>(run.first), run.last - run.first + 1, 1);
    file.write(std::as_bytes(std::span<const uint8_t>(row)));
  }
}

}  // namespace vpr
