// vpr-train descriptors and vpr-train export: descriptors from and for other programs.
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/npy.h"
#include "base/text.h"
#include "database/imported.h"
#include "present/database_report.h"
#include "recordings/sequence_source.h"
#include "train.h"

namespace vpr {
namespace {

struct ImportOptions {
  std::vector<std::string> arrays;
  std::string names;
  std::vector<std::string> ranges;
  bool as_bits = false;
  ImportSettings import;
  SequenceTrainSettings settings;
};

// "NAME=FIRST:LAST", a range of the rows of an array. The name may contain "=".
NamedArgument named_range(const std::string& text, const std::filesystem::path& array) {
  const size_t equals = text.rfind('=');
  if (equals != std::string::npos && equals > 0) {
    const SequenceArgument argument =
        parse_sequence_argument(fmt::format("{}@{}", array.string(), text.substr(equals + 1)));
    if (argument.path == array) return {text.substr(0, equals), argument};
  }
  throw Error(ErrorKind::usage, "--sequence takes NAME=FIRST:LAST, counted from 0, found {}", text);
}

std::vector<NamedArgument> find_sequences(const ImportOptions& options) {
  std::vector<SequenceArgument> arrays;
  for (const std::string& text : options.arrays) arrays.push_back(parse_sequence_argument(text));
  if (arrays.empty())
    throw Error(ErrorKind::usage,
                "descriptors are missing, as in --train db.npy, or a folder of .npy files");
  for (const SequenceArgument& array : arrays) require_descriptors(array);
  std::vector<NamedArgument> sequences;
  if (options.ranges.empty()) {
    const std::vector<std::string> names = sequence_names(arrays);
    for (size_t a = 0; a < arrays.size(); ++a) sequences.push_back({names[a], arrays[a]});
    return sequences;
  }
  if (arrays.size() != 1 || !arrays.front().range.is_all())
    throw Error(ErrorKind::usage,
                "--sequence needs a single --train without a range; for several arrays use ranges, "
                "as in --train A.npy@0:100 --train B.npy");
  for (const std::string& text : options.ranges) {
    sequences.push_back(named_range(text, arrays.front().path));
    for (size_t s = 0; s + 1 < sequences.size(); ++s)
      if (sequences[s].name == sequences.back().name)
        throw Error(ErrorKind::usage, "two sequences have the name {}", sequences[s].name);
  }
  return sequences;
}

// Names the frames by --names, which has one line per row of the array; sequences are ranges of it.
void name_frames(SequenceDatabase& database, const std::vector<NamedArgument>& sequences,
                 const ImportOptions& options) {
  if (options.names.empty()) return;
  if (options.arrays.size() != 1)
    throw Error(ErrorKind::usage, "--names needs a single --train, with one line per row");
  const std::string file = read_whole_file(options.names);
  const auto names = split_lines(file);
  const SequenceArgument array = parse_sequence_argument(options.arrays.front());
  const size_t rows = ArrayRows(open_sequence({array.path, {}})).count();
  if (names.size() != rows)
    throw Error(ErrorKind::data, "{}: names {}, and {} has {}", options.names,
                counted(names.size(), "frame"), array.path.string(), counted(rows, "row"));
  for (size_t s = 0; s < sequences.size(); ++s) {
    const FrameRange& range = sequences[s].sequence.range;
    std::vector<std::string>& own = database.sequences[s].sequence.frame_names;
    for (size_t i = 0; i < own.size(); ++i) own[i] = names[range.first + i * range.step];
  }
}

void import_descriptors(Session& session, const ImportOptions& options) {
  claim_database(session);
  SequenceTrainSettings settings = options.settings;
  settings.descriptor_kind = imported_kind(options.as_bits, options.import);
  const std::vector<NamedArgument> sequences = find_sequences(options);
  SequenceDatabase database = train_sequences(sequences, settings, session.monitor);
  name_frames(database, sequences, options);
  store_database(session, std::move(database));
}

template <class T>
std::vector<float> as_floats(DescriptorRow row, double unit) {
  std::vector<float> values;
  for (size_t i = 0; i < row.size(); i += sizeof(T)) {
    T value = 0;
    std::memcpy(&value, row.data() + i, sizeof(T));
    values.push_back(static_cast<float>(value * unit));
  }
  return values;
}

// Coordinates of points count units; vectors have any length.
std::vector<float> as_floats(const DescriptorStore& store, DescriptorRow row) {
  const ElementType element = store.shape().element;
  return element == ElementType::int8
             ? as_floats<int8_t>(row, 1)
             : as_floats<int16_t>(row, element == ElementType::points16 ? store.unit : 1);
}

// Exports bits and gray levels as uint8, vectors and points as float32, and of ldb+hog the code;
// unreadable frames are 0 or NaN.
void export_descriptors(const Session& session, const std::string& path, const std::string& file) {
  session.outputs.claim_file(file);
  const SequenceDatabase database = read_sequence_database(path);
  const DescriptorStore& store = database.descriptors;
  const DescriptorShape shape =
      store.shape().element == ElementType::ldb_hog ? kLdbShape : store.shape();
  const bool as_float =
      shape.element != ElementType::bits && shape.element != ElementType::gray_levels;
  const size_t columns = shape.element == ElementType::bits ? (shape.length + 7) / 8 : shape.length;
  const std::string_view type = as_float ? npy_type<float>() : npy_type<uint8_t>();
  const std::vector<float> no_floats(columns, std::numeric_limits<float>::quiet_NaN());
  const std::vector<uint8_t> no_bytes(columns);
  size_t zeros = 0;
  Output& output = session.outputs.file(file);
  output.write(npy_header(type, {store.rows().size(), columns}));
  for (const DescribedFrames& sequence : descriptor_spans(database)) {
    auto unreadable = sequence.unreadable.begin();
    for (size_t i = 0; i < sequence.rows.size(); ++i) {
      const bool is_missing = unreadable != sequence.unreadable.end() && *unreadable == i;
      if (is_missing) ++unreadable;
      zeros += is_missing && !as_float ? 1 : 0;
      const DescriptorRow row = sequence.rows[i];
      if (as_float)
        output.write(std::as_bytes(std::span(is_missing ? no_floats : as_floats(store, row))));
      else
        output.write(std::as_bytes(is_missing ? std::span(no_bytes) : row.first(columns)));
    }
  }
  if (zeros > 0)
    warn(session.monitor, "{}: {} that cannot be decoded {} only zeros, which other programs match",
         file, counted(zeros, "row"), zeros == 1 ? "has" : "have");
  session.print_result(fmt::format("{}: {} of {} values, {}\n", file,
                                   counted(store.rows().size(), "row"), columns, type),
                       database_json(database, session.run));
}

}  // namespace

void add_descriptors(Program& program) {
  const auto options = std::make_shared<ImportOptions>();
  SequenceTrainSettings& settings = options->settings;
  const Command command = program.add_command(
      "descriptors", "Build a database of descriptors from another program, such as a network.",
      "  vpr-train descriptors --train codes.npy --bits -o codes.vprdb\n"
      "  vpr-train descriptors --train vectors.npy --names names.txt -o network.vprdb\n"
      "  vpr-train descriptors --train vectors.npy --metric l2 --sequence monday=0:900 --sequence "
      "tuesday=900:1750 -o network.vprdb",
      [options](Session& session) { import_descriptors(session, *options); });
  program.add_config(command, settings);
  command.add_list("--train", options->arrays,
                   "training sequence: n x d values with one row per frame, float16, float32 or "
                   "float64, or with --bits uint8 or bool; or a folder with one .npy file per "
                   "frame; with an optional range db.npy@FIRST:LAST[:STEP]; repeatable");
  command.add_list(
      "--sequence", options->ranges,
      "NAME=FIRST:LAST: rows of a single --train that form a training sequence; from 0, "
      "without LAST; repeatable (default: all rows)");
  command.add_option("--names", options->names,
                     "text file with the names of the frames, one line per row of --train");
  command.add_flag("--bits", options->as_bits,
                   "compare bits by Hamming distance; 8 bits per uint8, or one per bool");
  add_setting(command, "--metric", options->import.metric,
              "distance of vectors (default: cosine); cosine: directions only; l2: Euclidean, "
              "lengths also count; chord: l2 of the vectors at length 1, with a finer resolution "
              "of small distances than cosine");
  add_setting(command, "--value-bits", options->import.value_bits,
              "bits per value of a vector: 16, or 8 for half the memory (default: 16)");
  add_setting(command, "--c-l", settings.window_length,
              "window length c_l of the automatic thresholds (default: 40)");
  add_setting(command, "--safety-factor", settings.safety_factor,
              "factor of the automatic thresholds (default: 1)");
  command.add_flag("--skip-unreadable", settings.skip_unreadable,
                   "ignore rows of only NaN; they keep their index and never match");
}

void add_export(Program& program) {
  struct Export {
    std::string database;
    std::string descriptors;
  };
  const auto options = std::make_shared<Export>();
  const Command command = program.add_command(
      "export", "Write a database as files for other programs.",
      "  vpr-train export corridor.vprdb --descriptors codes.npy", [options](Session& session) {
        export_descriptors(session, options->database, options->descriptors);
      });
  program.add_config(command);
  command.remove_flag("--output");
  command.add_option("DB", options->database, "database of a sequence method").required();
  command
      .add_option("--descriptors", options->descriptors,
                  "write one row per frame of all sequences (.npy): bits as uint8 with 8 bits per "
                  "value, vectors as float32, images as uint8",
                  kEssentialGroup, "FILE")
      .required();
}

}  // namespace vpr
