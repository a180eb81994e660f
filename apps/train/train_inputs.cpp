#include "train_inputs.h"

#include "base/error.h"
#include "base/json.h"
#include "present/database_report.h"
#include "sequence/sequence_source.h"
#include "store/archive.h"
#include "truth/dataset.h"

namespace vpr {

void add_inputs(const Command& command, TrainInputs& inputs) {
  command.add_list("--train", inputs.sequences,
                   "training sequence: a folder of images, a list (.txt) or a video, with an "
                   "optional range PATH@FIRST:LAST[:STEP]; repeatable");
  command.add_option("--train-folders", inputs.folders, "each sub-folder is a training sequence");
}

std::vector<NamedArgument> named_arguments(const TrainInputs& inputs,
                                           const std::vector<std::string>& taken) {
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

std::vector<NamedArgument> rated_arguments(const TrainInputs& inputs, const Session& session,
                                           const std::vector<std::string>& taken) {
  std::optional<Dataset> dataset;
  if (!inputs.dataset.empty()) dataset = read_dataset(inputs.dataset);
  std::vector<NamedArgument> named = named_arguments(inputs, taken);
  for (NamedArgument& argument : named)
    argument.sequence =
        selected(argument.sequence, inputs.selection, {}, dataset ? &*dataset : nullptr, session);
  return named;
}

void claim_database(const Session& session) {
  if (session.options.output.empty())
    throw Error(ErrorKind::usage, "give the database to write, as in -o DB.vprdb");
  session.outputs.claim_folder(session.options.output, is_database_folder);
}

void print_database(const Session& session, const SequenceDatabase& database,
                    const std::string& path, const std::string& more) {
  const std::vector<AutomaticThresholds> thresholds = stored_thresholds(database, session.monitor);
  session.print_result(database_text(database, thresholds, path) + more,
                       database_json(database, thresholds, session.run));
}

void store_sequences(const Session& session, const SequenceDatabase& database) {
  write_sequence_database(session.options.output, database, session.outputs);
  print_database(session, database, session.options.output, "");
}

}  // namespace vpr
