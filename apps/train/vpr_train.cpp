// vpr-train: builds, lists, verifies and extends databases.
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "database/archive.h"
#include "present/database_report.h"
#include "recordings/sequence_source.h"
#include "train.h"

namespace vpr {
namespace {

void print_database(const Session& session, const AnyDatabase& database, const std::string& path,
                    const std::string& note = "") {
  const auto print = [&](const auto& one) {
    session.print_result(database_text(one, path) + note, database_json(one, session.run));
  };
  std::visit(print, database);
}

// The sequences with their rates and selections.
std::vector<NamedArgument> selected_arguments(const TrainOptions& options, const Session& session,
                                              const std::vector<std::string>& taken = {}) {
  std::optional<Dataset> dataset;
  if (!options.dataset.empty()) dataset = read_dataset(options.dataset);
  std::vector<NamedArgument> named = named_arguments(options, taken);
  for (NamedArgument& argument : named)
    argument.sequence =
        selected(argument.sequence, options.selection, {}, dataset ? &*dataset : nullptr, session);
  return named;
}

void add_images(Program& program) {
  struct Images {
    TrainOptions options;
    SequenceTrainSettings settings;
  };
  const auto train = std::make_shared<Images>();
  SequenceTrainSettings& settings = train->settings;
  const Command command = program.add_command(
      "images", "Build a database of images or video: one descriptor per frame.",
      "  vpr-train images --train monday -o corridor.vprdb\n"
      "  vpr-train images --train-folders walks --c-l 20 -o walks.vprdb\n"
      "  vpr-train images --train monday.mp4 --fps 5 -o monday.vprdb",
      [train](Session& session) {
        claim_database(session);
        store_database(session, train_sequences(selected_arguments(train->options, session),
                                                train->settings, session.monitor));
      });
  command.add_alias("fastable");
  program.add_config(command, settings);
  add_inputs(command, train->options);
  add_rate_flags(command, train->options.selection, "training sequences");
  command.add_option("--dataset", train->options.dataset,
                     "data set description instead of sequences");
  std::vector<std::string> kinds;
  std::string summaries = "Descriptors:\n";
  for (const DescriptorKind& kind : descriptor_kinds()) {
    if (kind.is_imported) continue;
    kinds.emplace_back(kind.name);
    summaries += fmt::format("  {:<17}{}\n", kind.name, kind.summary);
  }
  add_setting(command, "--descriptor", settings.descriptor_kind,
              "descriptor of the frames, see below (default: ldb+hog)")
      .choices("NAME", kinds);
  command.add_footer(summaries);
  add_setting(command, "--c-l", settings.window_length,
              "window length c_l of the automatic thresholds (default: 40)");
  add_setting(command, "--safety-factor", settings.safety_factor,
              "factor of the automatic thresholds (default: 1)");
  add_setting(
      command, "--features", settings.features,
      "kind of the features of keyframes, for vpr-query --witness: orb or none (default: orb)",
      "Local features");
  command.add_flag("--illumination-invariant", settings.descriptor.illumination_invariant,
                   "decode in color and remove the color of the light");
  add_unreadable_flag(command, settings.skip_unreadable);
}

void add_info(Program& program) {
  const auto path = std::make_shared<std::string>();
  const Command command = program.add_command(
      "info", "List a database and verify its checksums.", "  vpr-train info corridor.vprdb",
      [path](Session& session) {
        print_database(session, read_database(*path), *path, "All checksums are right.\n");
      });
  program.add_config(command);
  command.remove_flag("--output");
  command.add_option("DB", *path, "database").required();
}

void extend_sequences(Session& session, const std::string& path, const TrainOptions& options) {
  if (!options.places.empty())
    throw Error(ErrorKind::usage, "{} is a database of sequences, which does not support --place",
                path);
  const SequenceDatabase database = read_sequence_database(path);
  store_database(session,
                 add_sequences(database, selected_arguments(options, session, names_of(database)),
                               options.skip_unreadable, session.monitor));
}

void extend_fabmap(Session& session, const std::string& path, const TrainOptions& options) {
  if (options.selection.fps || options.selection.recorded_fps)
    throw Error(ErrorKind::usage,
                "{} is a FAB-MAP database, which does not support --fps. Use a range with a "
                "step, as in PATH@::6",
                path);
  FabmapDatabase database = read_fabmap_database(path);
  add_views(database, group_arguments(options, names_of(database)), options.skip_unreadable,
            session.monitor);
  store_database(session, std::move(database));
}

void add_add(Program& program) {
  struct Add {
    std::string database;
    TrainOptions options;
  };
  const auto add = std::make_shared<Add>();
  const Command command = program.add_command(
      "add", "Extend a database with more sequences, without computing its descriptors again.",
      "  vpr-train add corridor.vprdb --train building/upstairs -o extended.vprdb\n"
      "  vpr-train add places.vprdb --place lift=lift -o more_places.vprdb",
      [add](Session& session) {
        session.outputs.release(add->database);  // it is read before it is replaced
        claim_database(session);
        const bool is_fabmap = database_family(add->database) == DatabaseFamily::fabmap;
        (is_fabmap ? extend_fabmap : extend_sequences)(session, add->database, add->options);
      });
  program.add_config(command);
  command.add_option("DB", add->database, "database to start from").required();
  add_inputs(command, add->options);
  add_place_option(command, add->options.places);
  add_rate_flags(command, add->options.selection, "training sequences");
  add_unreadable_flag(command, add->options.skip_unreadable);
}

}  // namespace

void add_inputs(const Command& command, TrainOptions& options) {
  command.add_list("--train", options.sequences,
                   "training sequence: folder of images, list (.txt) or video, with an optional "
                   "range PATH@FIRST:LAST[:STEP]; repeatable");
  command.add_option("--train-folders", options.folders,
                     "folder whose sub-folders are training sequences");
}

std::vector<NamedArgument> named_arguments(const TrainOptions& options,
                                           const std::vector<std::string>& taken) {
  std::vector<SequenceArgument> arguments;
  std::vector<NamedArgument> named;
  for (const std::string& text : options.sequences)
    arguments.push_back(parse_sequence_argument(text));
  if (!options.folders.empty())
    for (const SequenceArgument& argument : subfolder_arguments(options.folders))
      arguments.push_back(argument);
  if (!options.dataset.empty()) {
    if (!arguments.empty())
      throw Error(ErrorKind::usage, "--dataset and training sequences exclude each other");
    for (const NamedSequence& train : read_dataset(options.dataset).train)
      named.push_back({train.name, train.sequence});
  }
  const std::vector<std::string> names = sequence_names(arguments, taken);
  for (size_t i = 0; i < arguments.size(); ++i) named.push_back({names[i], arguments[i]});
  if (named.empty())
    throw Error(ErrorKind::usage, "a training sequence is missing, as in --train FOLDER");
  return named;
}

void claim_database(const Session& session) {
  if (session.options.output.empty())
    throw Error(ErrorKind::usage, "the output is missing, as in -o DB.vprdb");
  session.outputs.claim_folder(session.options.output, is_database_folder);
}

void store_database(const Session& session, const AnyDatabase& database) {
  const auto* windows = std::get_if<SequenceDatabase>(&database);
  for (const char* flag : {"--c-l", "--safety-factor"})
    if (windows != nullptr && windows->sequences.size() == 1 && session.command.is_given(flag))
      warn(session.monitor,
           "{} has no effect yet: it is for the automatic t_r, which needs two training sequences. "
           "vpr-train add appends another",
           flag);
  write_database(session.options.output, database, session.outputs);
  print_database(session, database, session.options.output,
                 fmt::format("next: vpr-query {} --query SEQUENCE -o result.json\n",
                             shell_word(session.options.output)));
}

}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-train", "Build, list and extend databases for visual place recognition.",
                  "  vpr-train images --train monday -o monday.vprdb");
  add_images(program);
  add_descriptors(program);
  add_fabmap(program);
  add_info(program);
  add_add(program);
  add_export(program);
  return program.main(argc, argv);
}
