#include "ground_truth/mat_file.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <matio.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "ground_truth/builder.h"
#include "ground_truth/mat_elements.h"
#include "ground_truth/matrix_shape.h"

namespace vpr {
namespace {

// What zlib makes of a byte at most, rounded up: a matrix has no more values.
constexpr size_t kMostValuesOfByte = 1100;
constexpr std::string_view kUsualName = "truth";

struct Closer {
  void operator()(mat_t* file) const { Mat_Close(file); }
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, Closer>;
using MatVariable = std::unique_ptr<matvar_t, Closer>;

bool is_numeric(const matvar_t& variable) {
  return variable.class_type >= MAT_C_SPARSE && variable.class_type <= MAT_C_UINT64;
}

bool is_matrix(const matvar_t& variable) {
  return is_numeric(variable) && variable.rank == 2 && variable.dims != nullptr &&
         variable.dims[0] * variable.dims[1] > 1 && variable.isComplex == 0;
}

std::string name_of(const matvar_t& variable) {
  return variable.name == nullptr ? "" : variable.name;
}

/// Of the only matrix, or of several the one with the usual name.
std::string find_matrix(const GroundTruthBuilder& builder, mat_t& file) {
  std::vector<std::string> names;
  while (const MatVariable variable{Mat_VarReadNextInfo(&file)})
    if (is_matrix(*variable)) names.push_back(name_of(*variable));
  if (names.size() == 1) return names.front();
  for (const std::string& name : names)
    if (name == kUsualName) return name;
  if (names.empty()) builder.fail("has no matrix of numbers, or is damaged");
  builder.fail(fmt::format("has several matrices ({}); keep one, or call it {}",
                           fmt::join(names, ", "), kUsualName));
}

MatVariable read_matrix(const GroundTruthBuilder& builder, mat_t& file, const std::string& name,
                        size_t file_bytes) {
  const MatVariable info{Mat_VarReadInfo(&file, name.c_str())};
  if (!info || !is_matrix(*info)) builder.fail(fmt::format("its matrix {} is damaged", name));
  const size_t rows = info->dims[0];
  const size_t cols = info->dims[1];
  const size_t stored = info->class_type == MAT_C_SPARSE ? cols : rows * cols;
  if (rows > kMostGrownFrames || cols > kMostGrownFrames || stored > file_bytes * kMostValuesOfByte)
    builder.fail(
        fmt::format("its matrix {} of {} x {} is too large for its file", name, rows, cols));
  MatVariable matrix{Mat_VarRead(&file, name.c_str())};
  if (!matrix || matrix->data == nullptr)
    builder.fail(fmt::format("its matrix {} is damaged", name));
  return matrix;
}

/// Calls `use(row, column)` for every one of the matrix.
template <class T, class Use>
void for_each_one(const GroundTruthBuilder& builder, const matvar_t& matrix, Use&& use) {
  const T* values = static_cast<const T*>(matrix.data);
  for (size_t column = 0; column < matrix.dims[1]; ++column) {
    builder.check_stop();
    for (size_t row = 0; row < matrix.dims[0]; ++row) {
      const T value = values[column * matrix.dims[0] + row];
      if (value == T{1}) use(row, column);
      if (value != T{0} && value != T{1})
        builder.fail(fmt::format("row {}, column {} of its matrix {} is {}; expected 0 or 1",
                                 row + 1, column + 1, name_of(matrix), value));
    }
  }
}

template <class Use>
void for_each_sparse(const GroundTruthBuilder& builder, const matvar_t& matrix, Use&& use) {
  const auto& sparse = *static_cast<const mat_sparse_t*>(matrix.data);
  const auto damaged = [&] {
    builder.fail(fmt::format("its sparse matrix {} is damaged", name_of(matrix)));
  };
  if (sparse.njc != matrix.dims[1] + 1 || sparse.jc == nullptr) damaged();
  for (size_t column = 0; column < matrix.dims[1]; ++column) {
    if (sparse.jc[column] > sparse.jc[column + 1] || sparse.jc[column + 1] > sparse.nir ||
        sparse.jc[column + 1] > sparse.ndata)
      damaged();
    for (size_t k = sparse.jc[column]; k < sparse.jc[column + 1]; ++k) {
      if (sparse.ir[k] >= matrix.dims[0]) damaged();
      const double value = matrix.data_type == MAT_T_DOUBLE
                               ? static_cast<const double*>(sparse.data)[k]
                               : static_cast<const uint8_t*>(sparse.data)[k];
      if (value == 1) use(sparse.ir[k], column);
      if (value != 0 && value != 1)
        builder.fail(fmt::format("row {}, column {} of its matrix {} is {}; expected 0 or 1",
                                 sparse.ir[k] + 1, column + 1, name_of(matrix), value));
    }
  }
}

template <class Use>
void visit_ones(const GroundTruthBuilder& builder, const matvar_t& matrix, Use&& use) {
  if (matrix.class_type == MAT_C_SPARSE) {
    const bool is_known = matrix.data_type == MAT_T_DOUBLE || matrix.data_size == 1;
    if (!is_known) builder.fail("the values of its sparse matrix are neither numbers nor logical");
    return for_each_sparse(builder, matrix, use);
  }
  switch (matrix.data_type) {
    case MAT_T_DOUBLE:
      return for_each_one<double>(builder, matrix, use);
    case MAT_T_SINGLE:
      return for_each_one<float>(builder, matrix, use);
    case MAT_T_INT8:
      return for_each_one<int8_t>(builder, matrix, use);
    case MAT_T_UINT8:
      return for_each_one<uint8_t>(builder, matrix, use);
    case MAT_T_INT16:
      return for_each_one<int16_t>(builder, matrix, use);
    case MAT_T_UINT16:
      return for_each_one<uint16_t>(builder, matrix, use);
    case MAT_T_INT32:
      return for_each_one<int32_t>(builder, matrix, use);
    case MAT_T_UINT32:
      return for_each_one<uint32_t>(builder, matrix, use);
    case MAT_T_INT64:
      return for_each_one<int64_t>(builder, matrix, use);
    case MAT_T_UINT64:
      return for_each_one<uint64_t>(builder, matrix, use);
    default:
      builder.fail(fmt::format("its matrix {} has values of an unknown kind", name_of(matrix)));
  }
}

}  // namespace

std::string read_mat_file(GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  const size_t sequence = builder.only_searched(path.string());
  const MappedFile bytes(path);
  require_whole_elements(builder, bytes.text());
  const MatFile file{Mat_Open(path.c_str(), MAT_ACC_RDONLY)};
  if (!file) builder.fail("is no MAT-file that can be read");
  const std::string name = find_matrix(builder, *file);
  const MatVariable matrix = read_matrix(builder, *file, name, bytes.text().size());
  const size_t rows = matrix->dims[0];
  const size_t cols = matrix->dims[1];
  const bool rows_are_query = require_matrix_shape(builder, sequence, rows, cols, true);
  visit_ones(builder, *matrix, [&](size_t row, size_t column) {
    const size_t reference = rows_are_query ? column : row;
    builder.add(rows_are_query ? row : column, sequence, reference, reference, PlaceLabel::same);
  });
  return fmt::format("matrix {} of {} x {}, rows are {} frames; within {} of a 1", name, rows, cols,
                     rows_are_query ? "query" : "training",
                     counted(static_cast<uint64_t>(builder.argument().tolerance_frames), "frame"));
}

bool is_mat_file(const FileStart& start) {
  return begins_as_mat_file(start.bytes) || (!start.is_folder && start.path.extension() == ".mat");
}

}  // namespace vpr
