#include "ground_truth/matrix_file.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/converters.h"
#include "base/error.h"
#include "base/npy.h"
#include "base/text.h"
#include "ground_truth/builder.h"
#include "ground_truth/label_runs.h"
#include "ground_truth/npy_stream.h"
#include "ground_truth/writing.h"

namespace vpr {
namespace {

constexpr std::string_view kHard = "GThard.npy";
constexpr std::string_view kSoft = "GTsoft.npy";
constexpr uint64_t kMostValues = 10'000'000'000;
constexpr uint64_t kMostArchiveValues = uint64_t{1} << 31;  // they are in memory
// With a first file, or none at all.
bool is_zip(std::string_view bytes) {
  return bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06");
}

std::optional<size_t> find_name(const ZipFile& archive, std::string_view name) {
  const auto found = std::find(archive.names().begin(), archive.names().end(), name);
  if (found == archive.names().end()) return std::nullopt;
  return static_cast<size_t>(found - archive.names().begin());
}

void require_same_shape(const GroundTruthBuilder& builder, const NpyStream& hard,
                        const NpyStream& soft) {
  if (hard.rows() != soft.rows() || hard.cols() != soft.cols() ||
      hard.is_transposed() != soft.is_transposed())
    builder.fail("the soft matrix has another shape or order than the hard one");
}

// Whether the rows are query frames: as the argument's matrix_rows says; else `usually`, unless
// only the other way fits the numbers of frames. Throws Error(data) if the shape does not fit.
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
        fmt::format("is a matrix of {} x {}, and there are {} query and {} training frames", rows,
                    cols, query.frames, train.frames));
  builder.require_query_frames(rows_are_query ? rows : cols);
  builder.require_train_frames(sequence, rows_are_query ? cols : rows);
  return rows_are_query;
}

// `usually_query`: rows of such a file are query frames, if nothing else is said.
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
                     soft == nullptr ? "" : "; what only the soft matrix has is ignored",
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
        fmt::format("{}: a .npz file holds its soft matrix itself, as GTsoft", path.string()));
  if (archive.names().empty()) builder.fail("is an archive without any matrix");
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

// One matrix whose rows are training frames, in the bytes of a .npy file.
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
  const size_t frames = ground_truth.scope.sequences[sequence].frames;
  const GroundTruth& truth = ground_truth.truth;
  const bool is_archive = file.path().extension() == ".npz";
  require_writable(uint64_t{truth.pairs.size()} * frames,
                   is_archive ? kMostArchiveValues : kMostValues, "values of a matrix");
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
