#include "truth/matrix_file.h"

#include <algorithm>
#include <cstring>
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
#include "base/text.h"
#include "base/zip_file.h"
#include "truth/builder.h"
#include "truth/ground_truth.h"
#include "truth/text_file.h"

namespace vpr {

namespace {

constexpr std::string_view kHard = "GThard.npy";
constexpr std::string_view kSoft = "GTsoft.npy";
constexpr uint64_t kMaxValues = 10'000'000'000;
constexpr uint64_t kMaxArchiveValues = uint64_t{1} << 31;  // the values are in memory
// With a first file, or an empty archive.
bool is_zip(std::string_view bytes) {
  return bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06");
}

std::optional<size_t> find_name(const ZipFile& archive, std::string_view name) {
  const auto found = std::find(archive.names().begin(), archive.names().end(), name);
  if (found == archive.names().end()) return std::nullopt;
  return static_cast<size_t>(found - archive.names().begin());
}

// Converts the values 0 and 1 of a row. Returns the index of the first other value.
template <class T>
size_t take_bits(std::span<const std::byte> bytes, std::span<uint8_t> values) {
  for (size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    if (!(value == T{0} || value == T{1})) return i;
    values[i] = value == T{1} ? 1 : 0;
  }
  return values.size();
}

struct BitType {
  std::string_view name;
  size_t (*take)(std::span<const std::byte>, std::span<uint8_t>);
};

const BitType* find_type(std::string_view name) {
  static constexpr BitType kTypes[] = {
      {"|b1", take_bits<uint8_t>},  {"|u1", take_bits<uint8_t>},  {"|i1", take_bits<int8_t>},
      {"<u2", take_bits<uint16_t>}, {"<i2", take_bits<int16_t>},  {"<u4", take_bits<uint32_t>},
      {"<i4", take_bits<int32_t>},  {"<u8", take_bits<uint64_t>}, {"<i8", take_bits<int64_t>},
      {"<f4", take_bits<float>},    {"<f8", take_bits<double>}};
  for (const BitType& type : kTypes)
    if (type.name == name) return &type;
  return nullptr;
}

/// Reads a matrix row by row in the order of the file: columns for a Fortran-ordered matrix.
class NpyStream {
 public:
  /// A separate .npy file. Throws Error(input) or Error(data).
  explicit NpyStream(const std::filesystem::path& path);
  /// A file of an archive, which must outlive this object.
  NpyStream(ZipFile& archive, size_t index, const std::string& where);

  size_t rows() const { return rows_; }
  size_t cols() const { return cols_; }
  /// Whether the rows in the file are columns of the matrix.
  bool is_transposed() const { return header_.is_column_major; }
  /// Writes the values of the next row, 0 or 1. Throws Error(data) for other values or if the file
  /// ends early.
  void next_row(std::span<uint8_t> values);
  /// Throws Error(data) if there are more bytes.
  void require_end();

 private:
  using Fill = std::function<size_t(std::span<std::byte>)>;
  void open();
  void read_bytes(std::span<std::byte> bytes);

  FileLocation location_;
  Fill fill_;
  NpyHeader header_;
  size_t rows_ = 0;
  size_t cols_ = 0;
  std::vector<std::byte> row_;
  size_t row_number_ = 0;
};

NpyStream::NpyStream(const std::filesystem::path& path) : location_{path.string()} {
  const auto file = std::make_shared<MappedFile>(path);
  fill_ = [file, at = size_t{0}](std::span<std::byte> bytes) mutable {
    const size_t count = std::min(bytes.size(), file->bytes().size() - at);
    std::copy_n(file->bytes().begin() + static_cast<ptrdiff_t>(at), count, bytes.begin());
    at += count;
    return count;
  };
  open();
}

NpyStream::NpyStream(ZipFile& archive, size_t index, const std::string& where) : location_{where} {
  const auto entry = std::make_shared<ZipFile::Entry>(archive, index);
  fill_ = [entry](std::span<std::byte> bytes) { return entry->read(bytes); };
  open();
}

void NpyStream::read_bytes(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const size_t count = fill_(bytes);
    if (count == 0) location_.fail("ends early; the file is truncated or damaged");
    bytes = bytes.subspan(count);
  }
}

void NpyStream::open() {
  constexpr size_t kFixed = 10;  // magic, version and, for version 1, the length of the rest
  std::string start(kFixed, '\0');
  const auto read_to = [&](size_t size) {
    const size_t before = start.size();
    if (size <= before) return;
    start.resize(size);
    read_bytes(std::as_writable_bytes(std::span(start)).subspan(before));
  };
  read_bytes(std::as_writable_bytes(std::span(start)));
  const auto byte = [&](size_t i) { return size_t{static_cast<uint8_t>(start[i])}; };
  size_t length = byte(8) | byte(9) << 8;
  if (byte(6) == 1) {
    read_to(kFixed + length);
  } else {
    read_to(kFixed + 2);
    length |= byte(10) << 16 | byte(11) << 24;
    if (length <= kMaxNpyHeader) read_to(kFixed + 2 + length);
  }
  const auto header = parse_npy_header(start);
  if (!header || find_type(header->type) == nullptr || header->shape.size() != 2)
    location_.fail("is not a little-endian matrix of bool, integers or floats (.npy)");
  header_ = *header;
  rows_ = header_.shape[header_.is_column_major ? 1 : 0];
  cols_ = header_.shape[header_.is_column_major ? 0 : 1];
}

void NpyStream::next_row(std::span<uint8_t> values) {
  row_.resize(cols_ * *npy_value_size(header_.type));
  read_bytes(row_);
  location_.at("row", row_number_++);
  const size_t good = find_type(header_.type)->take(row_, values);
  if (good < values.size())
    location_.fail(
        fmt::format("column {} is neither 0 nor 1; check that it is a ground truth", good));
}

void NpyStream::require_end() {
  std::byte more{};
  location_.at({}, 0);
  if (fill_({&more, 1}) != 0) location_.fail("is longer than its shape");
}

void require_same_shape(const GroundTruthBuilder& builder, const NpyStream& hard,
                        const NpyStream& soft) {
  if (hard.rows() != soft.rows() || hard.cols() != soft.cols() ||
      hard.is_transposed() != soft.is_transposed())
    builder.fail("the soft matrix has another shape or order than the hard one");
}

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
  const MatrixRows given = builder.argument().options.matrix_rows;
  bool rows_are_query = usually ? fits_query || !fits_reference : fits_query && !fits_reference;
  if (given != MatrixRows::automatic) rows_are_query = given == MatrixRows::query;
  if (!(rows_are_query ? fits_query : fits_reference))
    builder.fail(
        fmt::format("is a matrix of {} x {}, but there are {} query and {} training frames", rows,
                    cols, query.frames, train.frames));
  builder.require_query_frames(rows_are_query ? rows : cols);
  builder.require_train_frames(sequence, rows_are_query ? cols : rows);
  return rows_are_query;
}

// `usually_query`: whether the rows of this kind of file are query frames by default.
std::string read_streams(GroundTruthBuilder& builder, NpyStream& hard, NpyStream* soft,
                         bool usually_query) {
  const size_t sequence = builder.only_searched(builder.argument().path.string());
  if (soft != nullptr) require_same_shape(builder, hard, *soft);
  const bool flip = hard.is_transposed();
  const bool rows_are_query =
      require_matrix_shape(builder, sequence, flip ? hard.cols() : hard.rows(),
                           flip ? hard.rows() : hard.cols(), usually_query);
  const bool stored_rows_are_query = rows_are_query != flip;
  std::vector<uint8_t> same(hard.cols());
  std::vector<uint8_t> near(soft == nullptr ? 0 : hard.cols());
  for (size_t r = 0; r < hard.rows(); ++r) {
    builder.check_stop();
    hard.next_row(same);
    if (soft != nullptr) soft->next_row(near);
    for (size_t c = 0; c < same.size(); ++c) {
      const bool is_near = soft != nullptr && near[c] != 0;
      if (same[c] == 0 && !is_near) continue;
      const size_t reference = stored_rows_are_query ? c : r;
      builder.add(stored_rows_are_query ? r : c, sequence, reference, reference,
                  same[c] != 0 ? PlaceLabel::same : PlaceLabel::ignore);
    }
  }
  hard.require_end();
  if (soft != nullptr) soft->require_end();
  return fmt::format("matrix of {} x {}, rows are {} frames{}; within {} of a 1",
                     flip ? hard.cols() : hard.rows(), flip ? hard.rows() : hard.cols(),
                     rows_are_query ? "query" : "training",
                     soft == nullptr ? "" : "; pairs only in the soft matrix are ignored",
                     counted(static_cast<uint64_t>(builder.argument().tolerance_frames), "frame"));
}

std::string read_archive(GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  ZipFile archive(path);
  const auto open = [&](size_t index) {
    return NpyStream(archive, index, path.string() + ", " + archive.names()[index]);
  };
  if (!builder.argument().options.soft.empty())
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: a .npz file contains its soft matrix, named GTsoft", path.string()));
  if (archive.names().empty()) builder.fail("is an archive without a matrix");
  const auto hard = find_name(archive, kHard);
  const auto soft = find_name(archive, kSoft);
  if (!hard && archive.names().size() == 1) {
    NpyStream only = open(0);
    return read_streams(builder, only, nullptr, true);
  }
  if (!hard)
    builder.fail(fmt::format("expected the matrices GThard and GTsoft, found {}",
                             fmt::join(archive.names(), ", ")));
  NpyStream hard_stream = open(*hard);
  if (!soft) return read_streams(builder, hard_stream, nullptr, false);
  NpyStream soft_stream = open(*soft);
  return read_streams(builder, hard_stream, &soft_stream, false);
}

// Writes one matrix with training frames as rows, in the format of a .npy file.
ZipContent reference_rows(std::string_view name, const std::vector<std::vector<uint8_t>>& columns,
                          size_t references, uint8_t least_label) {
  struct State {
    std::string pending;
    size_t sent = 0;
    size_t row = 0;
  };
  auto state = std::make_shared<State>();
  state->pending = npy_header("|b1", {references, columns.size()});
  return {std::string(name), [=, &columns](std::span<std::byte> bytes) {
            if (state->sent == state->pending.size()) {
              if (state->row == references) return size_t{0};
              state->pending.resize(columns.size());
              for (size_t query = 0; query < columns.size(); ++query)
                state->pending[query] = columns[query][state->row] >= least_label ? 1 : 0;
              state->sent = 0;
              ++state->row;
            }
            const size_t count = std::min(bytes.size(), state->pending.size() - state->sent);
            const auto from = std::as_bytes(std::span(state->pending)).subspan(state->sent, count);
            std::copy(from.begin(), from.end(), bytes.begin());
            state->sent += count;
            return count;
          }};
}

constexpr uint8_t kIgnoredOrSame = 1;
constexpr uint8_t kSame = 2;

// 0 different, 1 ignored, 2 the same.
std::vector<uint8_t> label_codes(const GroundTruth& truth, size_t query, size_t sequence,
                                 size_t frames) {
  std::vector<uint8_t> codes(frames);
  for (const LabelRun& run : label_runs(truth, query, sequence, frames))
    std::fill(codes.begin() + static_cast<ptrdiff_t>(run.first),
              codes.begin() + static_cast<ptrdiff_t>(run.last) + 1,
              run.label == PlaceLabel::same ? kSame : kIgnoredOrSame);
  return codes;
}

void write_archive(const GroundTruth& truth, size_t sequence, size_t frames, Output& file,
                   const Monitor& monitor) {
  std::vector<std::vector<uint8_t>> columns;
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    columns.push_back(label_codes(truth, query, sequence, frames));
  }
  const std::string bytes = zip_archive({reference_rows(kHard, columns, frames, kSame),
                                         reference_rows(kSoft, columns, frames, kIgnoredOrSame)});
  file.write(bytes);
}

}  // namespace

bool is_matrix_file(const FileStart& start) {
  return start.bytes.starts_with("\x93NUMPY") || is_zip(start.bytes);
}

std::string read_matrix_file(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  const MappedFile file(argument.path);
  if (is_zip(file.text())) return read_archive(builder);
  refuse_unconverted(argument.path, file.text().substr(0, kMaxNpyHeader));
  NpyStream hard(argument.path);
  if (argument.options.soft.empty()) return read_streams(builder, hard, nullptr, true);
  NpyStream soft(argument.options.soft);
  return read_streams(builder, hard, &soft, true);
}

void write_matrix_file(const InspectedGroundTruth& ground_truth, Output& file,
                       const Monitor& monitor) {
  const size_t sequence = only_written_sequence(ground_truth, "matrix");
  const size_t frames = ground_truth.scope.sequences[sequence].sequence.frames;
  const GroundTruth& truth = ground_truth.truth;
  const bool is_archive = file.path().extension() == ".npz";
  require_writable(uint64_t{truth.pairs.size()} * frames,
                   is_archive ? kMaxArchiveValues : kMaxValues, "values of a matrix");
  if (is_archive) return write_archive(truth, sequence, frames, file, monitor);
  file.write(npy_header("|b1", {truth.pairs.size(), frames}));
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    std::vector<uint8_t> row = label_codes(truth, query, sequence, frames);
    for (uint8_t& value : row) value = value == kSame ? 1 : 0;
    file.write(std::as_bytes(std::span<const uint8_t>(row)));
  }
}

}  // namespace vpr
