// vpr-train: databases from frames; listing, checking and extending them.
#include <filesystem>

#include <fmt/format.h>

#include "command.h"
#include "database/archive.h"
#include "database/fabmap_database.h"
#include "database/openfabmap.h"
#include "images/dataset.h"
#include "pipeline/fabmap.h"
#include "pipeline/train.h"
#include "recognition/automatic_threshold.h"
#include "report/table.h"

namespace vpr {
namespace {

struct TrainInputs {
  std::vector<std::string> sequences;
  std::string folders;
  std::string dataset;
};

void add_inputs(CLI::App& command, TrainInputs& inputs) {
  add_list(command, "--train", inputs.sequences,
           "training sequence: a folder of images, a list (.txt) or a video, with an "
           "optional range PATH@FIRST:LAST[:STEP]; repeatable");
  command.add_option("--train-folders", inputs.folders, "each sub-folder is a training sequence");
}

/// "NAME=SEQ"; the name may not be empty.
GroupArgument place_argument(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(ErrorKind::usage, fmt::format("--place takes NAME=SEQUENCE, found {}", text));
  return {text.substr(0, equals), parse_sequence_argument(text.substr(equals + 1)), true};
}

struct FabmapInputs {
  TrainInputs train;
  std::vector<std::string> pretrain;
  std::vector<std::string> places;
  bool from_openfabmap = false;
  std::string vocabulary;
  std::string tree;
  std::string pretrain_bow;
  std::string train_bow;
};

std::vector<NamedArgument> named_arguments(const TrainInputs& inputs,
                                           const std::vector<std::string>& taken = {}) {
  std::vector<SequenceArgument> arguments;
  std::vector<NamedArgument> named;
  for (const std::string& text : inputs.sequences)
    arguments.push_back(parse_sequence_argument(text));
  if (!inputs.folders.empty())
    for (const SequenceArgument& argument : subfolder_arguments(inputs.folders))
      arguments.push_back(argument);
  if (!inputs.dataset.empty()) {
    if (!arguments.empty())
      throw Error(ErrorKind::usage, "give either --dataset or training sequences, not both");
    for (const NamedSequence& train : read_dataset(inputs.dataset).train)
      named.push_back({train.name, train.sequence});
  }
  const std::vector<std::string> names = sequence_names(arguments, taken);
  for (size_t i = 0; i < arguments.size(); ++i) named.push_back({names[i], arguments[i]});
  if (named.empty())
    throw Error(ErrorKind::usage, "give at least one training sequence, as in --train FOLDER");
  return named;
}

std::string threshold_text(const ThresholdTable& table, size_t sequence) {
  const auto& closest = table.closest[sequence];
  if (!closest) return "-";
  return fmt::format("{:.2f}",
                     automatic_threshold(*closest, table.window_length, table.safety_factor));
}

Table database_table(const SequenceDatabase& database, const std::string& title) {
  Table table;
  table.title = title;
  table.columns = {"sequence", "frames", "unreadable"};
  for (const ThresholdTable& thresholds : database.thresholds)
    table.columns.push_back(fmt::format("t_r at c_l {} (bits)", thresholds.window_length));
  for (size_t s = 0; s < database.sequences.size(); ++s) {
    const TrainSequence& sequence = database.sequences[s];
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {sequence.name, std::to_string(sequence.frame_count()),
           std::to_string(sequence.unreadable.size())};
    for (const ThresholdTable& thresholds : database.thresholds)
      row.push_back(threshold_text(thresholds, s));
  }
  return table;
}

Json database_json(const SequenceDatabase& database, const RunInfo& run) {
  Json json = {{"schema", "vpr.database-info/1"}, {"method", "fastable"}};
  json["settings"] = value_to_json(database.descriptor);
  json["sequences"] = Json::array();
  for (size_t s = 0; s < database.sequences.size(); ++s) {
    const TrainSequence& sequence = database.sequences[s];
    Json item = {{"name", sequence.name},
                 {"frames", sequence.frame_count()},
                 {"unreadable", sequence.unreadable.size()}};
    item["t_r"] = Json::array();
    for (const ThresholdTable& table : database.thresholds) {
      const auto& closest = table.closest[s];
      item["t_r"].push_back(
          {{"c_l", table.window_length},
           {"bits",
            closest ? Json(automatic_threshold(*closest, table.window_length, table.safety_factor))
                    : Json()}});
    }
    json["sequences"].push_back(item);
  }
  json["provenance"] = provenance_json(run);
  return json;
}

std::string summary(const SequenceDatabase& database, const std::string& path) {
  size_t frames = 0;
  for (const TrainSequence& sequence : database.sequences) frames += sequence.frame_count();
  std::string text =
      render_table(database_table(database, fmt::format("{}: fastable, {} sequences, {} frames",
                                                        path, database.sequences.size(), frames)),
                   TableFormat::text);
  if (database.sequences.size() == 1)
    text += "A single sequence gives no automatic t_r: queries need --t-r.\n";
  return text;
}

FabmapDatabase train_fabmap_frames(const FabmapInputs& inputs, const FabmapTrainSettings& settings,
                                   const Session& session) {
  std::vector<SequenceArgument> pretrain;
  std::vector<GroupArgument> groups;
  for (const std::string& text : inputs.pretrain) pretrain.push_back(parse_sequence_argument(text));
  if (!inputs.train.dataset.empty()) {
    const Dataset dataset = read_dataset(inputs.train.dataset);
    pretrain.insert(pretrain.end(), dataset.pretrain.begin(), dataset.pretrain.end());
    for (const DatasetPlace& place : dataset.places)
      for (const SequenceArgument& view : place.views) groups.push_back({place.name, view, true});
  }
  for (const std::string& text : inputs.places) groups.push_back(place_argument(text));
  if (groups.empty() || !inputs.train.sequences.empty() || !inputs.train.folders.empty())
    for (const NamedArgument& train : named_arguments(inputs.train))
      groups.push_back({train.name, train.sequence, false});
  if (pretrain.empty())
    throw Error(ErrorKind::usage,
                "give frames for the vocabulary that show other places, as in --pretrain FOLDER");
  return train_fabmap(pretrain, groups, settings, session.options.seed, session.monitor);
}

FabmapDatabase import_openfabmap(const FabmapInputs& inputs, const FabmapTrainSettings& settings) {
  for (const std::string& path :
       {inputs.vocabulary, inputs.tree, inputs.pretrain_bow, inputs.train_bow})
    if (path.empty())
      throw Error(ErrorKind::usage,
                  "--from-openfabmap needs --vocabulary, --tree, --pretrain-bow "
                  "and --train-bow");
  FabmapDatabase database;
  database.settings = settings;
  database.vocabulary = read_openfabmap_vocabulary(inputs.vocabulary);
  database.tree = read_openfabmap_tree(inputs.tree);
  database.settings.words = database.tree.words();
  if (static_cast<size_t>(database.vocabulary.rows) != database.tree.words())
    throw Error(ErrorKind::data,
                fmt::format("{}: has {} words, but the tree has {}", inputs.vocabulary,
                            database.vocabulary.rows, database.tree.words()));
  if (is_binary(settings.features.kind) ||
      database.vocabulary.cols != descriptor_length(settings.features.kind))
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: its words have {} dimensions, which {} does not; name the features "
                    "it was made of with --features",
                    inputs.vocabulary, database.vocabulary.cols,
                    enum_name(settings.features.kind)));
  for (const WordSet& frame :
       read_openfabmap_frames(parse_sequence_argument(inputs.pretrain_bow), database.tree.words()))
    database.pretrain.add(frame);
  const SequenceArgument train = parse_sequence_argument(inputs.train_bow);
  ViewGroup group{sequence_names({train}).front(), false, {}};
  for (const WordSet& frame : read_openfabmap_frames(train, database.tree.words())) {
    group.frame_names.push_back(fmt::format("#{}", group.frame_names.size()));
    database.views.add(frame);
  }
  database.groups.push_back(group);
  return database;
}

std::string fabmap_summary(const FabmapDatabase& database, const std::string& path) {
  Table table;
  table.title = fmt::format("{}: fabmap, {} words of {}, {} places, {} views", path,
                            database.tree.words(), enum_name(database.settings.features.kind),
                            database.place_names().size(), database.views.views());
  table.columns = {"group", "frames", "places", "words a frame"};
  size_t view = 0;
  for (const ViewGroup& group : database.groups) {
    const size_t first = view;
    view += group.frame_names.size();
    const auto words =
        static_cast<double>(database.views.offsets[view] - database.views.offsets[first]);
    table.rows.push_back({group.name, std::to_string(group.frame_names.size()),
                          group.is_place ? "one" : "each frame",
                          fmt::format("{:.1f}", words / static_cast<double>(view - first))});
  }
  return render_table(table, TableFormat::text);
}

Json fabmap_json(const FabmapDatabase& database, const RunInfo& run) {
  Json json = {{"schema", "vpr.database-info/1"}, {"method", "fabmap"}};
  json["settings"] = value_to_json(database.settings);
  json["words"] = database.tree.words();
  json["pretraining_frames"] = database.pretrain.views();
  json["views"] = database.views.views();
  json["places"] = database.place_names();
  json["provenance"] = provenance_json(run);
  return json;
}

void require_output(const CommonOptions& options) {
  if (options.output.empty())
    throw Error(ErrorKind::usage, "give the database to write, as in -o DB.vprdb");
  check_output_folder(options.output, options.existing(), is_database_folder);
}

void store(Session& session, const SequenceDatabase& database) {
  write_sequence_database(session.options.output, database, session.options.existing());
  session.print_result(summary(database, session.options.output),
                       database_json(database, session.run));
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-train", "Build, list and extend databases for visual place recognition.",
                  "  vpr-train fastable --train monday --train tuesday -o building.vprdb");

  TrainInputs inputs;
  SequenceTrainSettings settings;
  CLI::App& fastable = program.add_command(
      "fastable", "A database for FastABLE and OpenABLE: one LDB code a frame.",
      "  vpr-train fastable --train corridor/ref -o corridor.vprdb\n"
      "  vpr-train fastable --train-folders walks --c-l 20 -o walks.vprdb",
      [&](Session& session) {
        require_output(session.options);
        store(session,
              train_sequences(named_arguments(inputs), settings, session.kernels, session.monitor));
      });
  program.add_config(fastable, settings);
  add_inputs(fastable, inputs);
  fastable.add_option("--dataset", inputs.dataset, "data set description, instead of sequences");
  add_setting(fastable, "--c-l", settings.window_length,
              "window length c_l of the automatic thresholds (default 40)");
  add_setting(fastable, "--safety-factor", settings.safety_factor,
              "multiplies the automatic thresholds (default 1)");
  fastable.add_flag("--illumination-invariant", settings.descriptor.illumination_invariant,
                    "decode in colour and remove the light's colour first");
  fastable.add_flag("--skip-unreadable", settings.skip_unreadable,
                    "frames that can't be decoded keep their index and never match");

  FabmapInputs fabmap_inputs;
  FabmapTrainSettings fabmap_settings;
  CLI::App& fabmap = program.add_command(
      "fabmap", "A database for FAB-MAP: visual words of local features.",
      "  vpr-train fabmap --pretrain other/building --train corridor --features sift --words 500 "
      "-o fabmap.vprdb\n"
      "  vpr-train fabmap --pretrain walk --place hall=hall --place stairs=up --place stairs=down "
      "-o places.vprdb",
      [&](Session& session) {
        require_output(session.options);
        const FabmapDatabase database =
            fabmap_inputs.from_openfabmap
                ? import_openfabmap(fabmap_inputs, fabmap_settings)
                : train_fabmap_frames(fabmap_inputs, fabmap_settings, session);
        write_fabmap_database(session.options.output, database, session.options.existing());
        session.print_result(fabmap_summary(database, session.options.output),
                             fabmap_json(database, session.run));
      });
  program.add_config(fabmap, fabmap_settings);
  add_list(fabmap, "--pretrain", fabmap_inputs.pretrain,
           "sequence of other places, for the vocabulary and the tree; repeatable");
  add_inputs(fabmap, fabmap_inputs.train);
  add_list(fabmap, "--place", fabmap_inputs.places,
           "NAME=SEQUENCE: its frames are views of one place; repeatable");
  fabmap.add_option("--dataset", fabmap_inputs.train.dataset,
                    "data set description, instead of sequences");
  add_setting(fabmap, "--features", fabmap_settings.features.kind,
              "surf (default), sift, kaze, akaze, orb or brisk");
  add_setting(fabmap, "--words", fabmap_settings.words, "words of the vocabulary (default 1000)");
  fabmap.add_flag("--skip-unreadable", fabmap_settings.skip_unreadable,
                  "frames that can't be decoded keep their index and show no words");
  fabmap.add_flag("--from-openfabmap", fabmap_inputs.from_openfabmap,
                  "import OpenFABMAP's files (OpenCV YAML, also .gz) instead");
  fabmap.add_option("--vocabulary", fabmap_inputs.vocabulary, "OpenFABMAP's vocabulary");
  fabmap.add_option("--tree", fabmap_inputs.tree, "OpenFABMAP's Chow-Liu tree");
  fabmap.add_option("--pretrain-bow", fabmap_inputs.pretrain_bow,
                    "OpenFABMAP's BOW matrix of the pretraining frames, with an optional range");
  fabmap.add_option("--train-bow", fabmap_inputs.train_bow,
                    "OpenFABMAP's BOW matrix of the places, with an optional range");

  std::string database_path;
  CLI::App& info = program.add_command(
      "info", "List a database, and verify its checksums.", "  vpr-train info corridor.vprdb",
      [&](Session& session) {
        const std::string verified = "All checksums are right.\n";
        if (database_method(database_path) == "fabmap") {
          const FabmapDatabase database = read_fabmap_database(database_path);
          session.print_result(fabmap_summary(database, database_path) + verified,
                               fabmap_json(database, session.run));
        } else {
          const SequenceDatabase database = read_sequence_database(database_path);
          session.print_result(summary(database, database_path) + verified,
                               database_json(database, session.run));
        }
      });
  info.add_option("DB", database_path, "database")->required();

  TrainInputs added;
  bool skip_unreadable = false;
  CLI::App& add = program.add_command(
      "add", "A new database with more sequences; the old ones are not described again.",
      "  vpr-train add building.vprdb --train wednesday -o building2.vprdb", [&](Session& session) {
        require_output(session.options);
        const SequenceDatabase database = read_sequence_database(database_path);
        std::vector<std::string> taken;
        for (const TrainSequence& sequence : database.sequences) taken.push_back(sequence.name);
        const std::vector<NamedArgument> arguments = named_arguments(added, taken);
        store(session, add_sequences(database, arguments, skip_unreadable, session.kernels,
                                     session.monitor));
      });
  add.add_option("DB", database_path, "database to start from")->required();
  add_inputs(add, added);
  add.add_flag("--skip-unreadable", skip_unreadable,
               "frames that can't be decoded keep their index and never match");
  return program.main(argc, argv);
}
