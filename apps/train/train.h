// The command lines of vpr-train.
#pragma once

#include <string>
#include <vector>

#include "common/flags.h"
#include "fabmap/database.h"
#include "fabmap/word_training.h"

namespace vpr {

/// Training frames on the command line.
struct TrainOptions {
  std::vector<std::string> sequences;
  std::string folders;
  std::string dataset;
  std::vector<std::string> places;  ///< NAME=SEQUENCE, for FAB-MAP
  SelectionSettings selection;      ///< for sequence methods
  bool skip_unreadable = false;
};

/// --train and --train-folders.
void add_inputs(const Command& command, TrainOptions& options);
void add_place_option(const Command& command, std::vector<std::string>& places);

/// The named training sequences; names differ from each other and from `taken`. Throws Error(usage)
/// without a sequence.
std::vector<NamedArgument> named_arguments(const TrainOptions& options,
                                           const std::vector<std::string>& taken);

/// The views of --train, --train-folders and --place, named as in named_arguments.
std::vector<NamedArgument> group_arguments(const TrainOptions& options,
                                           const std::vector<std::string>& taken = {});

/// Claims the database of --output. Throws Error(usage) without --output.
void claim_database(const Session& session);

/// Writes a database to --output and prints its contents.
void store_database(const Session& session, const AnyDatabase& database);

/// vpr-train descriptors, vpr-train export and vpr-train fabmap.
void add_descriptors(Program& program);
void add_export(Program& program);
void add_fabmap(Program& program);

}  // namespace vpr
