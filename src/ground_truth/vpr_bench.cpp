#include "ground_truth/vpr_bench.h"

#include <optional>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/mapped_file.h"
#include "base/npy.h"
#include "ground_truth/builder.h"
#include "ground_truth/formats.h"
#include "ground_truth/label_runs.h"
#include "ground_truth/pickle.h"
#include "ground_truth/writing.h"

namespace vpr {
namespace {

using namespace std::string_view_literals;

// Every row of a small file may name the same long list: where the number of frames does not bound
// the work, this does.
constexpr uint64_t kMostReferences = uint64_t{1} << 26;

void add_reference(GroundTruthBuilder& builder, size_t query, size_t sequence,
                   std::optional<int64_t> reference) {
  if (!reference) builder.fail("a reference is not a whole number");
  if (*reference < 0)
    return builder.note_out_of_range("reference", std::to_string(*reference),
                                     builder.train(sequence));
  const auto index = static_cast<size_t>(*reference);
  builder.add(query, sequence, index, index, PlaceLabel::same);
}

void add_references(GroundTruthBuilder& builder, const Pickle& pickle, size_t query,
                    size_t sequence, const PickleValue& references) {
  const auto count = pickle.length(references);
  if (!count) builder.fail("expected a list of references");
  const FrameCount& train = builder.train(sequence);
  const uint64_t most = train.grows ? kMostReferences / builder.query().frames : train.frames;
  if (*count > most)
    builder.fail(fmt::format("lists {} references, more than there are frames", *count));
  for (uint64_t i = 0; i < *count; ++i)
    add_reference(builder, query, sequence, pickle.whole_number(references, i));
}

// A row (query, references) for every query.
void read_rows(GroundTruthBuilder& builder, const Pickle& pickle, size_t sequence) {
  const PickleObject& array = pickle.object(pickle.root());
  const auto& items = pickle.elements(array);
  for (size_t row = 0; row < array.shape[0]; ++row) {
    builder.at("row", row);
    const auto query = Pickle::whole_number(items[2 * row]);
    if (!query) builder.fail("its query is not a whole number");
    if (*query < 0 || static_cast<size_t>(*query) >= builder.query().frames)
      builder.note_out_of_range("query", std::to_string(*query), builder.query());
    else
      add_references(builder, pickle, static_cast<size_t>(*query), sequence, items[2 * row + 1]);
  }
}

const PickleObject& require_array(const GroundTruthBuilder& builder, const Pickle& pickle,
                                  const NpyHeader& header) {
  if (pickle.root().kind != PickleKind::array) builder.fail("holds something else than an array");
  const PickleObject& array = pickle.object(pickle.root());
  const bool is_known = array.shape.size() == 1 || (array.shape.size() == 2 && array.shape[1] == 2);
  if (array.type != "O" || array.shape != header.shape || !is_known)
    builder.fail("expected an array of a row (query, references) for every query");
  return array;
}

// Pickle instructions, of protocol 2.
void put_number(std::string& out, size_t value) {
  if (value < 256) {
    out += {'K', static_cast<char>(value)};
  } else {
    out += 'J';
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xff);
  }
}

std::string array_start(size_t rows) {
  std::string out = "\x80\x02";
  out += "cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK"sv;
  out +=
      "\0\x85U\x01"
      "b\x87R(K\x01"sv;
  put_number(out, rows);
  out += "K\x02\x86"sv;  // the shape
  out += "cnumpy\ndtype\nU\x02O8K\0K\x01\x87R"sv;
  out += "(K\x03U\x01|NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK?tb"sv;
  return out + "\x89](";
}

}  // namespace

bool is_vpr_bench(const FileStart& start) {
  const auto header = parse_npy_header(start.bytes);
  return header && header->type == "|O";
}

std::string read_vpr_bench(GroundTruthBuilder& builder) {
  const std::filesystem::path& path = builder.argument().path;
  const size_t sequence = builder.only_searched(path.string());
  const MappedFile file(path);
  const auto header = parse_npy_header(file.text());
  if (!header || header->type != "|O" || header->is_column_major)
    builder.fail("is no .npy array of Python objects");
  const Pickle pickle(file.text().substr(header->offset), {path.string()});
  const PickleObject& array = require_array(builder, pickle, *header);
  builder.require_query_frames(array.shape[0]);
  if (array.shape.size() == 2) {
    read_rows(builder, pickle, sequence);
  } else {
    const auto& items = pickle.elements(array);
    for (size_t row = 0; row < array.shape[0]; ++row) {
      builder.at("row", row);
      add_references(builder, pickle, row, sequence, items[row]);
    }
  }
  return fmt::format("vpr-bench: the references listed for each of {}, within {}",
                     counted(array.shape[0], "query", "queries"),
                     counted(static_cast<uint64_t>(builder.argument().tolerance_frames), "frame"));
}

void write_vpr_bench(const InspectedGroundTruth& ground_truth, OutputFile& file,
                     const Monitor& monitor) {
  const size_t sequence = only_written_sequence(ground_truth, "vpr-bench");
  const size_t frames = ground_truth.scope.sequences[sequence].frames;
  const size_t rows = ground_truth.truth.pairs.size();
  file.write(npy_header("|O", {rows, 2}));
  file.write(array_start(rows));
  for (size_t query = 0; query < rows; ++query) {
    check_stop(monitor);
    std::string row;
    put_number(row, query);
    row += "](";
    for (const LabelRun& run : label_runs(ground_truth.truth, query, sequence, frames))
      for (size_t reference = run.first; run.label == PlaceLabel::same && reference <= run.last;
           ++reference) {
        put_number(row, reference);
        write_piece(file, row, monitor);
      }
    file.write(row + "e");
  }
  file.write("etb.");
}

}  // namespace vpr
