// What the command lines of vpr-train share.
#pragma once

#include <string>
#include <vector>

#include "common/command.h"
#include "common/selection_flags.h"
#include "describe/imported.h"
#include "fabmap/database.h"
#include "fabmap/train.h"
#include "run/train.h"

namespace vpr {

struct TrainInputs {
  std::vector<std::string> sequences;
  std::string folders;
  std::string dataset;
  SelectionFlags selection;  ///< of fastable, and of add to such a database
};

/// --train and --train-folders.
void add_inputs(const Command& command, TrainInputs& inputs);

/// The training sequences with their names, none of which is in `taken`. Throws Error(usage) if
/// there is none.
std::vector<NamedArgument> named_arguments(const TrainInputs& inputs,
                                           const std::vector<std::string>& taken = {});

/// The same with their rates, thinned to --fps. Throws what `rated` throws, too.
std::vector<NamedArgument> rated_arguments(const TrainInputs& inputs, const Session& session,
                                           const std::vector<std::string>& taken = {});

/// Claims the database of --output. Throws Error(usage) if none is named.
void claim_database(const Session& session);

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

/// What the flags of the command `fabmap` write to.
struct FabmapCommand {
  FabmapInputs inputs;
  FabmapTrainSettings settings;
};

/// What the flags of the command `descriptors` write to.
struct DescriptorsCommand {
  std::vector<std::string> arrays;
  std::string names;
  std::vector<std::string> ranges;
  bool as_bits = false;
  uint64_t precision = 16;
  DescriptorMetric metric = DescriptorMetric::cosine;
  SequenceTrainSettings settings;
};

/// The command `descriptors`; `command` must live as long as the program.
void add_descriptors_command(Program& program, DescriptorsCommand& command);

/// Writes the descriptors of a database to a .npy file, which is claimed, and says so.
void export_descriptors(const Session& session, const std::string& path, const std::string& file);

/// Prints what a database of sequences holds, and `more` below it.
void print_database(const Session& session, const SequenceDatabase& database,
                    const std::string& path, const std::string& more);

/// Writes a database of sequences, and prints what it holds.
void store_sequences(const Session& session, const SequenceDatabase& database);

/// The command `fabmap`; `command` must live as long as the program.
void add_fabmap_command(Program& program, FabmapCommand& command);

/// The views of --train, --train-folders and --place. Groups of frames are named apart from those
/// in `taken`. Throws Error(usage) if there are none.
std::vector<GroupArgument> group_arguments(const TrainInputs& train,
                                           const std::vector<std::string>& places,
                                           const std::vector<std::string>& taken = {});

/// --place, into `places`.
void add_place_option(const Command& command, std::vector<std::string>& places);

/// Writes a FAB-MAP database, and prints what it holds.
void store_fabmap(const Session& session, const FabmapDatabase& database);

}  // namespace vpr
