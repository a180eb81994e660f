// Matrices of MATLAB, written by the library that reads them.
#include <array>

#include <catch2/catch.hpp>
#include <matio.h>
#include <zlib.h>

#include "base/error.h"
#include "ground_truth/truth_files.h"

using namespace vpr;
using test::Files;

namespace {

/// A variable of a file; values in columns, as MATLAB has them.
struct Variable {
  std::string name;
  matio_classes kind;
  matio_types type;
  std::vector<size_t> shape;
  void* values;
  int flags = 0;
};

void write_mat(const std::filesystem::path& path, const std::vector<Variable>& variables,
               mat_ft version = MAT_FT_MAT5, matio_compression packed = MAT_COMPRESSION_ZLIB) {
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version);
  REQUIRE(file != nullptr);
  for (const Variable& v : variables) {
    matvar_t* variable =
        Mat_VarCreate(v.name.c_str(), v.kind, v.type, static_cast<int>(v.shape.size()),
                      const_cast<size_t*>(v.shape.data()), v.values, v.flags);
    REQUIRE(variable != nullptr);
    REQUIRE(Mat_VarWrite(file, variable, packed) == 0);
    Mat_VarFree(variable);
  }
  Mat_Close(file);
}

// A number of four bytes, the lowest first, as this machine's library writes them.
std::string four_bytes(size_t number) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(number >> 8 * i & 255);
  return bytes;
}

// A file with the elements of another one, packed together.
std::string packed(const std::string& file) {
  constexpr size_t kHeader = 128;
  uLongf length = compressBound(file.size());
  std::string bytes(length, '\0');
  REQUIRE(compress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                   reinterpret_cast<const Bytef*>(file.data() + kHeader),
                   file.size() - kHeader) == Z_OK);
  bytes.resize(length);
  return file.substr(0, kHeader) + four_bytes(15) + four_bytes(length) + bytes;
}

}  // namespace

TEST_CASE("a MATLAB matrix of two rows and three columns, in every version of its files") {
  const Files files;
  // 1 0 1
  // 0 0 1
  std::vector<double> values = {1, 0, 0, 0, 1, 1};
  const Variable truth{"truth", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 3}, values.data()};
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    write_mat(files.folder / "g.mat", {truth}, version);
    CHECK(files.read("g.mat", 2, 3) == "S.S ..S");
    CHECK(files.read("g.mat", 3, 2) == "S. .. SS");  // only the other way fits
  }
  write_mat(files.folder / "g.mat", {truth}, MAT_FT_MAT5, MAT_COMPRESSION_NONE);
  write_mat(files.folder / "four.mat", {truth}, MAT_FT_MAT4, MAT_COMPRESSION_NONE);
  CHECK(test::error_text([&] { files.read("four.mat", 2, 3); }).find("save it anew") !=
        std::string::npos);
  GroundTruthArgument argument{"mat", "g.mat", 1};
  CHECK(files.read(argument, 2, 3) == "SSS .SS");
  CHECK(test::error_kind([&] { files.read("g.mat", 2, 4); }) == ErrorKind::data);
}

TEST_CASE("of several variables the only matrix counts, or that which is called truth") {
  const Files files;
  std::vector<uint8_t> bits = {0, 1, 1, 0};
  std::vector<double> number = {0.5};
  const Variable logical{"loops", MAT_C_UINT8, MAT_T_UINT8, {2, 2}, bits.data(), MAT_F_LOGICAL};
  const Variable radius{"radius", MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 1}, number.data()};
  write_mat(files.folder / "g.mat", {radius, logical});
  CHECK(files.read("g.mat", 2, 2) == ".S S.");
  std::vector<int32_t> others = {1, 0, 0, 1};
  const Variable truth{"truth", MAT_C_INT32, MAT_T_INT32, {2, 2}, others.data()};
  write_mat(files.folder / "g.mat", {logical, truth});
  CHECK(files.read("g.mat", 2, 2) == "S. .S");
  Variable poses = truth;
  poses.name = "poses";
  write_mat(files.folder / "g.mat", {logical, poses});
  CHECK(test::error_text([&] {
          files.read("g.mat", 2, 2);
        }).find("several matrices (loops, poses)") != std::string::npos);
  write_mat(files.folder / "g.mat", {radius});
  CHECK(test::error_kind([&] { files.read("g.mat", 2, 2); }) == ErrorKind::data);
}

TEST_CASE("a sparse matrix of MATLAB is read like a full one") {
  const Files files;
  std::vector<mat_uint32_t> rows = {2, 0, 1};
  std::vector<mat_uint32_t> starts = {0, 1, 1, 3};  // columns of one, none and two
  std::vector<double> values = {1, 1, 1};
  mat_sparse_t sparse{};
  sparse.nzmax = sparse.nir = sparse.ndata = 3;
  sparse.ir = rows.data();
  sparse.njc = 4;
  sparse.jc = starts.data();
  sparse.data = values.data();
  const Variable truth{"truth", MAT_C_SPARSE, MAT_T_DOUBLE, {3, 3}, &sparse, MAT_F_DONT_COPY_DATA};
  write_mat(files.folder / "g.mat", {truth});
  CHECK(files.read("g.mat", 3, 3) == "..S ..S S..");
}

TEST_CASE("other values, cut files and what is no MAT-file are damage") {
  const Files files;
  std::vector<double> values = {1, 0, 0.5, 0};
  write_mat(files.folder / "g.mat", {{"m", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 2}, values.data()}});
  CHECK(test::error_text([&] {
          files.read("g.mat", 2, 2);
        }).find("row 1, column 2 of its matrix m is 0.5") != std::string::npos);
  std::vector<double> good(400);
  write_mat(files.folder / "g.mat", {{"m", MAT_C_DOUBLE, MAT_T_DOUBLE, {20, 20}, good.data()}},
            MAT_FT_MAT5, MAT_COMPRESSION_NONE);
  const std::string bytes = test::read_text(files.folder / "g.mat");
  CHECK(files.read("g.mat", 20, 20).find('S') == std::string::npos);
  for (const size_t length : {size_t{0}, size_t{100}, size_t{130}, size_t{200}, bytes.size() / 2}) {
    files.text("g.mat", bytes.substr(0, length));
    INFO(length << ": " << test::error_text([&] { files.read("g.mat", 20, 20); }));
    CHECK(test::error_kind([&] { files.read("g.mat", 20, 20); }) == ErrorKind::data);
  }
  files.text("g.mat", "frame,x,y\n");
  CHECK(test::error_kind([&] {
          files.read(GroundTruthArgument{"mat", "g.mat"}, 20, 20);
        }) == ErrorKind::data);
}

TEST_CASE("lengths in packed matrices are not trusted") {
  const Files files;
  std::vector<double> values(100'000);
  write_mat(files.folder / "g.mat", {{"m", MAT_C_DOUBLE, MAT_T_DOUBLE, {100, 1000}, values.data()}},
            MAT_FT_MAT5, MAT_COMPRESSION_NONE);
  const std::string plain = test::read_text(files.folder / "g.mat");
  const auto error_of = [&](const std::string& file) {
    files.text("g.mat", file);
    return test::error_text([&] { files.read("g.mat", 100, 1000); });
  };
  CHECK(error_of(packed(plain)).empty());
  // The version is a number; what the text says before it does not count.
  std::string longest = plain;
  longest.replace(156, 4, four_bytes(0xf0000000));
  CHECK(error_of(longest.replace(0, 10, "MATLAB 7.3")).find("longer than itself") !=
        std::string::npos);
  // What the matrix and each of its four parts claim: flags, shape, name and values.
  constexpr size_t kMatrix = 132;
  std::vector<size_t> lengths = {140, 156};
  CHECK(plain.substr(140, 4) == four_bytes(8));
  CHECK(plain.substr(156, 4) == four_bytes(8));
  const size_t value_length = plain.size() - values.size() * sizeof(double) - 4;
  CHECK(plain.substr(value_length, 4) == four_bytes(values.size() * sizeof(double)));
  lengths.push_back(value_length);
  for (const size_t at : lengths) {
    std::string longer = plain;
    longer.replace(at, 4, four_bytes(0xf0000000));
    CHECK(error_of(packed(longer)).find("longer than itself") != std::string::npos);
    longer.replace(kMatrix, 4, four_bytes(0xf8000000));
    CHECK(error_of(packed(longer))
              .find(at == lengths.front() ? "does not begin as one" : "damaged or cut off") !=
          std::string::npos);
  }
  for (const size_t left : {size_t{133}, size_t{328}, plain.size() / 2, plain.size() - 1})
    CHECK(error_of(packed(plain.substr(0, left))).find("damaged or cut off") != std::string::npos);
  std::string broken = packed(plain);
  broken.replace(140, 8, "notzlib!");
  CHECK(error_of(broken).find("damaged or cut off") != std::string::npos);
}

TEST_CASE("cells and structures beside the matrix are passed over, and their lengths not trusted") {
  const Files files;
  std::vector<double> bits = {0, 1, 1, 0};
  const auto number = [&] {
    return Mat_VarCreate("x", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, std::array<size_t, 2>{2, 2}.data(),
                         bits.data(), 0);
  };
  const std::filesystem::path path = files.folder / "g.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  std::array<size_t, 2> shape = {3, 1};
  std::array<matvar_t*, 3> cells = {number(), number(), number()};
  std::array<const char*, 2> names = {"first", "second"};
  for (matvar_t* variable :
       {Mat_VarCreate("cells", MAT_C_CELL, MAT_T_CELL, 2, shape.data(), cells.data(), 0),
        Mat_VarCreateStruct("fields", 2, shape.data(), names.data(), 2),
        Mat_VarCreate("truth", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, std::array<size_t, 2>{2, 2}.data(),
                      bits.data(), 0)}) {
    REQUIRE(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE) == 0);
    Mat_VarFree(variable);
  }
  Mat_Close(file);
  CHECK(files.read("g.mat", 2, 2) == ".S S.");
  // Wherever a shape of 3 x 1 is, more rows than bytes.
  const std::string plain = test::read_text(path);
  const std::string rows = four_bytes(5) + four_bytes(8) + four_bytes(3) + four_bytes(1);
  size_t found = 0;
  for (size_t at = plain.find(rows); at != std::string::npos; at = plain.find(rows, at + 1)) {
    std::string more = plain;
    more.replace(at + 8, 4, four_bytes(0xffffffff));
    for (const bool is_packed : {false, true}) {
      if (is_packed && found > 0) continue;  // one element of a file is packed at a time
      files.text("g.mat", is_packed ? packed(more) : more);
      CHECK(test::error_text([&] { files.read("g.mat", 2, 2); }).find("longer than itself") !=
            std::string::npos);
    }
    ++found;
  }
  CHECK(found == 2);
}
