// vpr-train fabmap: a vocabulary, a Chow-Liu tree, and the words of all views.

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "fabmap/word_training.h"
#include "recordings/sequence_source.h"
#include "train.h"
#include "truth/places.h"

namespace vpr {
namespace {

struct FabmapOptions {
  TrainOptions train;
  std::vector<std::string> pretrain;
  std::string marked;  ///< CSV of places
  bool from_openfabmap = false;
  std::string vocabulary;
  std::string tree;
  FabmapTrainSettings settings;
};

bool has_sequences(const TrainOptions& options) {
  return !options.sequences.empty() || !options.folders.empty() || !options.dataset.empty();
}

// The marked training frames, each a place.
std::vector<NamedArgument> marked_arguments(const TrainOptions& options, const std::string& path) {
  const std::vector<NamedArgument> sequences = named_arguments(options, {});
  std::vector<NamedArgument> groups;
  for (const MarkedPlace& place : read_marked_places(path)) {
    const auto named = std::ranges::find(sequences, place.sequence, &NamedArgument::name);
    if (named == sequences.end())
      throw Error(ErrorKind::data, "{}: there is no training sequence \"{}\"", path,
                  place.sequence);
    NamedArgument& group = groups.emplace_back(
        NamedArgument{fmt::format("{}#{}", place.sequence, place.frame), named->sequence, true});
    FrameRange& range = group.sequence.range;
    const auto frames = frame_count(range);
    if (frames && place.frame >= *frames)
      throw Error(ErrorKind::data, "{}: {} has no frame {}", path, place.sequence, place.frame);
    const uint64_t frame = range.first + place.frame * range.step;
    range = {frame, frame + 1};
  }
  return groups;
}

FabmapDatabase train_frames(const FabmapOptions& options, const Session& session) {
  refuse(!(options.vocabulary + options.tree).empty(), "a file of OpenFABMAP",
         "needs --from-openfabmap");
  std::vector<SequenceArgument> pretrain;
  std::vector<NamedArgument> groups;
  for (const std::string& text : options.pretrain)
    pretrain.push_back(parse_sequence_argument(text));
  TrainOptions train = options.train;
  if (!train.dataset.empty()) {
    const Dataset dataset = read_dataset(train.dataset);
    pretrain.insert(pretrain.end(), dataset.pretrain.begin(), dataset.pretrain.end());
    if (options.marked.empty())
      for (const DatasetPlace& place : dataset.places)
        for (const SequenceArgument& view : place.views) groups.push_back({place.name, view, true});
    if (!groups.empty()) train.dataset.clear();
  }
  refuse(!options.marked.empty() && !train.places.empty(), "--marked-places",
         "and --place exclude each other");
  // A database without views is for vpr-query loops.
  if (!options.marked.empty())
    groups = marked_arguments(train, options.marked);
  else if (has_sequences(train) || !train.places.empty())
    for (const NamedArgument& group : group_arguments(train)) groups.push_back(group);
  if (pretrain.empty())
    throw Error(ErrorKind::usage,
                "frames of other places for the vocabulary are missing, as in --pretrain FOLDER");
  return train_fabmap(pretrain, groups, options.settings, session.options.process.seed,
                      session.monitor);
}

FabmapDatabase import_files(const FabmapOptions& options) {
  const TrainOptions& train = options.train;
  refuse(!train.folders.empty() || !train.dataset.empty() || !train.places.empty() ||
             !options.marked.empty(),
         "--from-openfabmap", "reads words of frames from --pretrain and --train only");
  if (options.vocabulary.empty() || options.tree.empty() || options.pretrain.size() != 1 ||
      train.sequences.size() != 1)
    throw Error(ErrorKind::usage,
                "--from-openfabmap needs --vocabulary, --tree, one --pretrain and one --train");
  const SequenceArgument pretrain = parse_sequence_argument(options.pretrain.front());
  const SequenceArgument words = parse_sequence_argument(train.sequences.front());
  for (const SequenceArgument& array : {pretrain, words}) require_descriptors(array);
  return import_openfabmap({options.vocabulary, options.tree, pretrain, words}, options.settings);
}

}  // namespace

std::vector<NamedArgument> group_arguments(const TrainOptions& options,
                                           const std::vector<std::string>& taken) {
  std::vector<NamedArgument> groups;
  for (const std::string& text : options.places) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error(ErrorKind::usage, "--place takes NAME=SEQUENCE, found {}", text);
    groups.push_back(
        {text.substr(0, equals), parse_sequence_argument(text.substr(equals + 1)), true});
  }
  if (groups.empty() || has_sequences(options))
    for (const NamedArgument& named : named_arguments(options, taken)) groups.push_back(named);
  return groups;
}

void add_place_option(const Command& command, std::vector<std::string>& places) {
  command.add_list("--place", places,
                   "NAME=SEQUENCE: frames that are views of one place, for FAB-MAP; repeatable");
}

void add_fabmap(Program& program) {
  const auto options = std::make_shared<FabmapOptions>();
  FabmapTrainSettings& settings = options->settings;
  const Command command = program.add_command(
      "fabmap", "Build a database for FAB-MAP: visual words of local features.",
      "  vpr-train fabmap --pretrain building/upstairs --train monday --words 200 -o fabmap.vprdb\n"
      "  vpr-train fabmap --pretrain upstairs --place hall=hall --place stairs=up --place "
      "stairs=down -o places.vprdb",
      [options](Session& session) {
        claim_database(session);
        store_database(session, options->from_openfabmap ? import_files(*options)
                                                         : train_frames(*options, session));
      });
  program.add_config(command, settings);
  command.add_list("--pretrain", options->pretrain,
                   "sequence of other places, for the vocabulary and the tree; repeatable");
  add_inputs(command, options->train);
  add_place_option(command, options->train.places);
  command.add_option("--marked-places", options->marked,
                     "training frames that are places, by the page of vpr-eval --ask-fabmap "
                     "(default: each frame)");
  command.add_option("--dataset", options->train.dataset,
                     "data set description instead of sequences");
  add_setting(command, "--features", settings.features.kind, "local features (default: surf)");
  add_setting(command, "--words", settings.words, "words of the vocabulary (default: 1000)");
  command.add_flag("--skip-unreadable", settings.skip_unreadable,
                   "ignore frames that cannot be decoded; they keep their index and have no words");
  constexpr const char* kOpenfabmap = "OpenFABMAP";
  add_setting(
      command, "--clustering", settings.clustering,
      "clustering of descriptors; radius: OpenFABMAP's sequential clustering (default: kmeans)",
      kOpenfabmap);
  add_setting(command, "--cluster-radius", settings.radius,
              "radius of radius clustering, in the unit of the features (bits for binary ones)",
              kOpenfabmap);
  command.add_flag("--from-openfabmap", options->from_openfabmap,
                   "import the .npy files of scripts/convert/openfabmap.py; --pretrain and --train "
                   "are its BOW matrices of other places and of the training frames",
                   kOpenfabmap);
  command.add_option("--vocabulary", options->vocabulary, "OpenFABMAP's vocabulary (.npy)",
                     kOpenfabmap);
  command.add_option("--tree", options->tree, "OpenFABMAP's Chow-Liu tree (.npy)", kOpenfabmap);
}

}  // namespace vpr
