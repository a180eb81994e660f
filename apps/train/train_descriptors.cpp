// vpr-train descriptors: a database of what another program describes frames by.
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "describe/imported.h"
#include "sequence/sequence_source.h"
#include "train_inputs.h"

namespace vpr {
namespace {

// "NAME=FIRST:LAST" of the only array.
NamedArgument range_argument(const std::string& text, const SequenceArgument& array) {
  const size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(ErrorKind::usage, fmt::format("--sequence takes NAME=FIRST:LAST, found {}", text));
  const SequenceArgument argument =
      parse_sequence_argument(fmt::format("{}@{}", array.path.string(), text.substr(equals + 1)));
  if (argument.path != array.path)
    throw Error(
        ErrorKind::usage,
        fmt::format("--sequence takes NAME=FIRST:LAST, rows that are numbered from 0, found "
                    "{}",
                    text));
  return {text.substr(0, equals), argument};
}

std::vector<NamedArgument> find_sequences(const DescriptorsCommand& given) {
  std::vector<SequenceArgument> arrays;
  for (const std::string& text : given.arrays) arrays.push_back(parse_sequence_argument(text));
  if (arrays.empty())
    throw Error(ErrorKind::usage,
                "give descriptors, as in --npy db.npy, or a folder of .npy files");
  for (const SequenceArgument& array : arrays)
    if (open_sequence(array).kind != SequenceKind::descriptors)
      throw Error(ErrorKind::usage,
                  fmt::format("{}: is no .npy file, nor a folder with .npy files and no images",
                              array.path.string()));
  std::vector<NamedArgument> sequences;
  if (given.ranges.empty()) {
    const std::vector<std::string> names = sequence_names(arrays);
    for (size_t a = 0; a < arrays.size(); ++a) sequences.push_back({names[a], arrays[a]});
    return sequences;
  }
  if (arrays.size() != 1 || !arrays.front().range.is_all())
    throw Error(ErrorKind::usage,
                "--sequence names rows of one --npy; give several as --npy A.npy --npy B.npy, with "
                "ranges as in A.npy@0:100");
  for (const std::string& text : given.ranges)
    sequences.push_back(range_argument(text, arrays.front()));
  for (size_t s = 0; s < sequences.size(); ++s)
    for (size_t before = 0; before < s; ++before)
      if (sequences[before].name == sequences[s].name)
        throw Error(ErrorKind::usage,
                    fmt::format("two sequences are called {}", sequences[s].name));
  return sequences;
}

std::vector<std::string> read_names(const std::string& path) {
  const MappedFile file(path);
  std::vector<std::string> names;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text())))
    names.emplace_back(line);
  return names;
}

// --names has a line for every row of the array, of which sequences take ranges.
void name_frames(SequenceDatabase& database, const std::vector<NamedArgument>& sequences,
                 const DescriptorsCommand& given) {
  if (given.names.empty()) return;
  if (given.arrays.size() != 1)
    throw Error(ErrorKind::usage, "--names has a line for every row of one --npy");
  const std::vector<std::string> names = read_names(given.names);
  const SequenceArgument array = parse_sequence_argument(given.arrays.front());
  const size_t rows = ArrayRows(open_sequence({array.path, {}})).count();
  if (names.size() != rows)
    throw Error(ErrorKind::data, fmt::format("{}: names {}, and {} has {}", given.names,
                                             counted(names.size(), "frame"), array.path.string(),
                                             counted(rows, "row")));
  for (size_t s = 0; s < sequences.size(); ++s) {
    const FrameRange& range = sequences[s].sequence.range;
    std::vector<std::string>& own = database.sequences[s].sequence.frame_names;
    for (size_t i = 0; i < own.size(); ++i) own[i] = names[range.first + i * range.step];
  }
}

std::string_view kind_of(const DescriptorsCommand& given) {
  if (given.precision != 8 && given.precision != 16)
    throw Error(ErrorKind::usage, fmt::format("--precision must be 16 or 8 bits a number, found {}",
                                              given.precision));
  const bool is_cosine = given.metric == DescriptorMetric::cosine;
  if (given.as_bits && (given.precision != 16 || !is_cosine))
    throw Error(ErrorKind::usage, "--precision and --metric are for vectors; --bits are exact");
  if (!is_cosine && given.precision != 16)
    throw Error(ErrorKind::usage,
                fmt::format("--metric {} takes numbers of 16 bits; leave --precision out",
                            enum_name(given.metric)));
  if (given.as_bits) return kBitKind;
  if (!is_cosine) return given.metric == DescriptorMetric::l2 ? kPointKind : kDirectionKind;
  return given.precision == 16 ? kVectorKind : kNarrowVectorKind;
}

void train(Session& session, const DescriptorsCommand& given) {
  claim_database(session);
  SequenceTrainSettings settings = given.settings;
  settings.descriptor_kind = kind_of(given);
  const std::vector<NamedArgument> sequences = find_sequences(given);
  SequenceDatabase database =
      train_sequences(sequences, settings, session.kernels, session.monitor);
  name_frames(database, sequences, given);
  store_sequences(session, database);
}

}  // namespace

void add_descriptors_command(Program& program, DescriptorsCommand& given) {
  const Command command = program.add_command(
      "descriptors",
      "A database of descriptors that another program computed, such as a network's.",
      "  vpr-train descriptors --npy db.npy --names db.txt -o walk.vprdb\n"
      "  vpr-train descriptors --npy db.npy --sequence monday=0:900 --sequence tuesday=900:1750 "
      "-o building.vprdb\n"
      "  vpr-train descriptors --npy db.npy --metric l2 -o walk.vprdb\n"
      "  vpr-train descriptors --npy codes.npy --bits -o codes.vprdb",
      [&given](Session& session) { train(session, given); });
  program.add_config(command, given.settings);
  command.add_list("--npy", given.arrays,
                   "n x d numbers, a row a frame: float16, float32 or float64 (cosine distances), "
                   "or with --bits uint8 or bool; or a folder with a .npy file a frame; a training "
                   "sequence, with an optional range db.npy@FIRST:LAST[:STEP]; repeatable");
  command.add_list("--sequence", given.ranges,
                   "NAME=FIRST:LAST: these rows of the one --npy are a training sequence (from 0, "
                   "without LAST); repeatable (default: all rows are one)");
  command.add_option("--names", given.names,
                     "text file with a line for every row of --npy: what its frame is called");
  command.add_flag("--bits", given.as_bits,
                   "uint8 are 8 bits a number, bool a bit each (Hamming distances)");
  add_setting(command, "--metric", given.metric,
              "cosine (default: only directions count), l2 (Euclidean, for vectors whose lengths "
              "count) or chord (l2 of the vectors at length 1: the order of cosine, finer where "
              "frames are nearly alike)");
  add_setting(command, "--precision", given.precision,
              "bits of a number of vectors: 16 (default), or 8, which take half the memory");
  add_setting(command, "--c-l", given.settings.window_length,
              "window length c_l of the automatic thresholds (default 40)");
  add_setting(command, "--safety-factor", given.settings.safety_factor,
              "multiplies the automatic thresholds (default 1)");
  command.add_flag("--skip-unreadable", given.settings.skip_unreadable,
                   "rows that are all NaN keep their index and never match");
}

}  // namespace vpr
