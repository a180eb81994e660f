// vpr-train fabmap: a vocabulary, a Chow-Liu tree, and the words of every view.
#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "fabmap/openfabmap.h"
#include "fabmap/train.h"
#include "present/database_report.h"
#include "sequence/sequence_source.h"
#include "train_inputs.h"
#include "truth/dataset.h"

namespace vpr {
namespace {

/// "NAME=SEQ"; the name may not be empty.
GroupArgument place_argument(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(ErrorKind::usage, fmt::format("--place takes NAME=SEQUENCE, found {}", text));
  return {text.substr(0, equals), parse_sequence_argument(text.substr(equals + 1)), true};
}

bool has_views(const TrainInputs& train, const std::vector<std::string>& places) {
  return !train.sequences.empty() || !train.folders.empty() || !train.dataset.empty() ||
         !places.empty();
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
  // Without a place at all, the database is for queries with --loop.
  TrainInputs train = inputs.train;
  if (!groups.empty()) train.dataset.clear();
  if (has_views(train, inputs.places))
    for (const GroupArgument& group : group_arguments(train, inputs.places))
      groups.push_back(group);
  if (pretrain.empty())
    throw Error(ErrorKind::usage,
                "give frames for the vocabulary that show other places, as in --pretrain FOLDER");
  return train_fabmap(pretrain, groups, settings, session.options.seed, session.monitor);
}

FabmapDatabase import_files(const FabmapInputs& inputs, const FabmapTrainSettings& settings) {
  for (const std::string& path :
       {inputs.vocabulary, inputs.tree, inputs.pretrain_bow, inputs.train_bow})
    if (path.empty())
      throw Error(ErrorKind::usage,
                  "--from-openfabmap needs --vocabulary, --tree, --pretrain-bow "
                  "and --train-bow");
  return import_openfabmap(
      {inputs.vocabulary, inputs.tree, parse_sequence_argument(inputs.pretrain_bow),
       parse_sequence_argument(inputs.train_bow)},
      settings);
}

}  // namespace

std::vector<GroupArgument> group_arguments(const TrainInputs& train,
                                           const std::vector<std::string>& places,
                                           const std::vector<std::string>& taken) {
  std::vector<GroupArgument> groups;
  for (const std::string& text : places) groups.push_back(place_argument(text));
  if (groups.empty() || has_views(train, {}))
    for (const NamedArgument& named : named_arguments(train, taken))
      groups.push_back({named.name, named.sequence, false});
  return groups;
}

void store_fabmap(const Session& session, const FabmapDatabase& database) {
  write_fabmap_database(session.options.output, database, session.outputs);
  session.print_result(database_text(database, session.options.output),
                       database_json(database, session.run));
}

void add_place_option(const Command& command, std::vector<std::string>& places) {
  command.add_list("--place", places,
                   "NAME=SEQUENCE: its frames are views of one place; repeatable (FAB-MAP)");
}

void add_fabmap_command(Program& program, FabmapCommand& command) {
  FabmapInputs& fabmap_inputs = command.inputs;
  FabmapTrainSettings& fabmap_settings = command.settings;
  const Command fabmap = program.add_command(
      "fabmap", "A database for FAB-MAP: visual words of local features.",
      "  vpr-train fabmap --pretrain other/building --train corridor --features sift --words 500 "
      "-o fabmap.vprdb\n"
      "  vpr-train fabmap --pretrain walk --place hall=hall --place stairs=up --place stairs=down "
      "-o places.vprdb",
      [&fabmap_inputs, &fabmap_settings](Session& session) {
        claim_database(session);
        const FabmapDatabase database =
            fabmap_inputs.from_openfabmap
                ? import_files(fabmap_inputs, fabmap_settings)
                : train_fabmap_frames(fabmap_inputs, fabmap_settings, session);
        store_fabmap(session, database);
      });
  program.add_config(fabmap, fabmap_settings);
  fabmap.add_list("--pretrain", fabmap_inputs.pretrain,
                  "sequence of other places, for the vocabulary and the tree; repeatable");
  add_inputs(fabmap, fabmap_inputs.train);
  add_place_option(fabmap, fabmap_inputs.places);
  fabmap.add_option("--dataset", fabmap_inputs.train.dataset,
                    "data set description, instead of sequences");
  add_setting(fabmap, "--features", fabmap_settings.features.kind,
              "surf (default), sift, kaze, akaze, orb or brisk");
  add_setting(fabmap, "--words", fabmap_settings.words, "words of the vocabulary (default 1000)");
  add_setting(fabmap, "--clustering", fabmap_settings.clustering,
              "kmeans (default), or radius: OpenFABMAP's sequential clustering");
  add_setting(fabmap, "--radius", fabmap_settings.radius,
              "of radius clustering, in the unit of the features (bits for binary ones)");
  fabmap.add_flag("--skip-unreadable", fabmap_settings.skip_unreadable,
                  "frames that can't be decoded keep their index and show no words");
  fabmap.add_flag("--from-openfabmap", fabmap_inputs.from_openfabmap,
                  "import OpenFABMAP's files as .npy, which scripts/convert/openfabmap.py writes");
  fabmap.add_option("--vocabulary", fabmap_inputs.vocabulary, "OpenFABMAP's vocabulary (.npy)");
  fabmap.add_option("--tree", fabmap_inputs.tree, "OpenFABMAP's Chow-Liu tree (.npy)");
  fabmap.add_option(
      "--pretrain-bow", fabmap_inputs.pretrain_bow,
      "OpenFABMAP's BOW matrix of the pretraining frames (.npy), with an optional range");
  fabmap.add_option("--train-bow", fabmap_inputs.train_bow,
                    "OpenFABMAP's BOW matrix of the places (.npy), with an optional range");
}

}  // namespace vpr
