// vpr-train: databases from frames; listing, checking and extending them.
#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "fabmap/database.h"
#include "present/database_report.h"
#include "store/archive.h"
#include "train_inputs.h"

namespace vpr {
namespace {

/// What `add` adds.
struct AddInputs {
  TrainInputs train;
  std::vector<std::string> places;
  bool skip_unreadable = false;
};

void add_to_sequences(Session& session, const std::string& path, const AddInputs& inputs) {
  if (!inputs.places.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: is a database for fastable, which has no --place", path));
  const SequenceDatabase database = read_sequence_database(path);
  std::vector<std::string> taken;
  for (const TrainSequence& train : database.sequences) taken.push_back(train.sequence.name);
  store_sequences(session, add_sequences(database, rated_arguments(inputs.train, session, taken),
                                         inputs.skip_unreadable, session.kernels, session.monitor));
}

void add_to_fabmap(Session& session, const std::string& path, const AddInputs& inputs) {
  if (inputs.train.selection.fps || inputs.train.selection.recorded_fps)
    throw Error(ErrorKind::usage,
                fmt::format("{}: is a database for fabmap, whose views are not thinned by --fps; "
                            "give a range with a step, as in PATH@::6",
                            path));
  FabmapDatabase database = read_fabmap_database(path);
  std::vector<std::string> taken;
  for (const ViewGroup& group : database.groups) taken.push_back(group.sequence.name);
  add_views(database, group_arguments(inputs.train, inputs.places, taken), inputs.skip_unreadable,
            session.monitor);
  store_fabmap(session, database);
}

std::vector<std::string> described_kinds() {
  std::vector<std::string> names;
  for (const DescriptorKind& kind : descriptor_kinds())
    if (!kind.is_imported) names.emplace_back(kind.name);
  return names;
}

std::string descriptor_help() {
  std::string text = "Descriptors:\n";
  for (const DescriptorKind& kind : descriptor_kinds())
    if (!kind.is_imported) text += fmt::format("  {:<17}{}\n", kind.name, kind.summary);
  return text;
}

/// What `vpr-train fastable` is told.
struct FastableCommand {
  TrainInputs inputs;
  SequenceTrainSettings settings;
};

void add_fastable_command(Program& program, FastableCommand& given) {
  const Command fastable = program.add_command(
      "fastable", "A database for FastABLE and OpenABLE: one descriptor a frame.",
      "  vpr-train fastable --train corridor/ref -o corridor.vprdb\n"
      "  vpr-train fastable --train-folders walks --c-l 20 -o walks.vprdb\n"
      "  vpr-train fastable --train monday.mp4 --fps 5 -o monday.vprdb",
      [&](Session& session) {
        claim_database(session);
        store_sequences(session, train_sequences(rated_arguments(given.inputs, session),
                                                 given.settings, session.kernels, session.monitor));
      });
  program.add_config(fastable, given.settings);
  add_inputs(fastable, given.inputs);
  add_rate_flags(fastable, given.inputs.selection, "training sequences");
  fastable.add_option("--dataset", given.inputs.dataset,
                      "data set description, instead of sequences");
  add_setting(fastable, "--descriptor", given.settings.descriptor_kind,
              "what frames are described by (default ldb); see Descriptors below")
      .choices("NAME", described_kinds());
  fastable.add_footer(descriptor_help());
  add_setting(fastable, "--c-l", given.settings.window_length,
              "window length c_l of the automatic thresholds (default 40)");
  add_setting(fastable, "--safety-factor", given.settings.safety_factor,
              "multiplies the automatic thresholds (default 1)");
  fastable.add_flag("--illumination-invariant", given.settings.descriptor.illumination_invariant,
                    "decode in color and remove the light's color first");
  fastable.add_flag("--skip-unreadable", given.settings.skip_unreadable,
                    "frames that can't be decoded keep their index and never match");
}

/// What the commands that start from a database are told.
struct DatabaseCommands {
  std::string path;
  AddInputs added;
  std::string descriptors;
  NoSettings settings;
};

void print_info(Session& session, const std::string& path) {
  const std::string verified = "All checksums are right.\n";
  if (database_family(path) == DatabaseFamily::fabmap) {
    const FabmapDatabase database = read_fabmap_database(path);
    session.print_result(database_text(database, path) + verified,
                         database_json(database, session.run));
  } else {
    print_database(session, read_sequence_database(path), path, verified);
  }
}

void add_info_command(Program& program, DatabaseCommands& given) {
  const Command info = program.add_command(
      "info", "List a database, and verify its checksums.", "  vpr-train info corridor.vprdb",
      [&](Session& session) { print_info(session, given.path); });
  program.add_config(info, given.settings);
  info.add_option("DB", given.path, "database").required();
}

void add_add_command(Program& program, DatabaseCommands& given) {
  const Command add = program.add_command(
      "add", "A new database with more sequences; the old ones are not described again.",
      "  vpr-train add building.vprdb --train wednesday -o building2.vprdb\n"
      "  vpr-train add places.vprdb --place lift=lift -o places2.vprdb",
      [&](Session& session) {
        session.outputs.release(given.path);  // it is extended in place, once it was read
        claim_database(session);
        if (database_family(given.path) == DatabaseFamily::fabmap)
          add_to_fabmap(session, given.path, given.added);
        else
          add_to_sequences(session, given.path, given.added);
      });
  program.add_config(add, given.settings);
  add.add_option("DB", given.path, "database to start from").required();
  add_inputs(add, given.added.train);
  add_place_option(add, given.added.places);
  add_rate_flags(add, given.added.train.selection, "training sequences");
  add.add_flag("--skip-unreadable", given.added.skip_unreadable,
               "frames that can't be decoded keep their index and never match");
}

void add_export_command(Program& program, DatabaseCommands& given) {
  const Command command = program.add_command(
      "export", "Write a database as files that other programs read.",
      "  vpr-train export corridor.vprdb --descriptors corridor.npy",
      [&](Session& session) { export_descriptors(session, given.path, given.descriptors); });
  program.add_config(command, given.settings);
  command.add_option("DB", given.path, "database").required();
  command
      .add_option(
          "--descriptors", given.descriptors,
          "of sequences: a row a frame, of all sequences (.npy): bits as uint8, 8 a number, "
          "vectors as float32, pictures as uint8")
      .type_name("FILE")
      .required();
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-train", "Build, list and extend databases for visual place recognition.",
                  "  vpr-train fastable --train monday --train tuesday -o building.vprdb");
  FastableCommand fastable;
  add_fastable_command(program, fastable);
  DescriptorsCommand descriptors;
  add_descriptors_command(program, descriptors);
  FabmapCommand fabmap;
  add_fabmap_command(program, fabmap);
  DatabaseCommands database;
  add_info_command(program, database);
  add_add_command(program, database);
  add_export_command(program, database);
  return program.main(argc, argv);
}
