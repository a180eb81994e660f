#include "eval_pictures.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "images/sequence.h"
#include "report/evaluation_charts.h"
#include "report/html_report.h"

namespace vpr {
namespace {

void require_frames(const Sequence& sequence, size_t expected, const std::string& what) {
  if (sequence.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::usage,
                fmt::format("{}: holds descriptors; pictures need the images that "
                            "they describe",
                            sequence.argument.path.string()));
  if (sequence.kind == SequenceKind::video || sequence.files.size() == expected) return;
  throw Error(ErrorKind::usage,
              fmt::format("{}: has {} frames, and {} has {}; give the sequence that was evaluated",
                          sequence.argument.path.string(), sequence.files.size(), what, expected));
}

/// Training sequences as --train or the data set names them.
std::vector<NamedSequence> find_train(const PictureInputs& inputs,
                                      const std::optional<Dataset>& dataset) {
  if (inputs.train.empty()) return dataset ? dataset->train : std::vector<NamedSequence>{};
  std::vector<NamedSequence> train;
  for (const std::string& text : inputs.train) train.push_back({"", parse_sequence_argument(text)});
  return train;
}

std::vector<std::optional<Sequence>> open_references(const std::vector<NamedSequence>& train,
                                                     const GroundTruthScope& scope) {
  std::vector<std::optional<Sequence>> references(scope.sequences.size());
  if (train.empty()) return references;
  if (train.size() < scope.sequences.size())
    throw Error(ErrorKind::usage, fmt::format("{} training sequences are given for pictures, and "
                                              "the evaluation has {}; give all, in its order",
                                              train.size(), scope.sequences.size()));
  for (size_t s = 0; s < references.size(); ++s) {
    const auto named = std::find_if(train.begin(), train.end(), [&](const NamedSequence& t) {
      return !t.name.empty() && t.name == scope.sequences[s].name;
    });
    references[s] = open_sequence((named == train.end() ? train[s] : *named).sequence);
    const GroundTruthScope::TrainSequence& known = scope.sequences[s];
    require_frames(*references[s], known.kept ? known.kept->recorded_frames : known.frames,
                   known.name);
  }
  return references;
}

FrameSources find_frames(const PictureInputs& inputs, const std::string& dataset_path,
                         const Evaluation& evaluation) {
  const GroundTruthScope& scope = evaluation.judgement.layout.scope;
  FrameSources sources;
  std::optional<Dataset> dataset;
  if (!dataset_path.empty()) dataset = read_dataset(dataset_path);
  if (dataset) {
    const std::string& name = evaluation.query_name;
    const bool is_named =
        std::any_of(dataset->queries.begin(), dataset->queries.end(),
                    [&](const DatasetQuery& query) { return query.sequence.name == name; });
    sources.query = open_sequence(
        select_query(*dataset, is_named ? std::optional(name) : inputs.query).sequence.sequence);
  } else if (inputs.query) {
    sources.query = open_sequence(parse_sequence_argument(*inputs.query));
  }
  if (sources.query)
    require_frames(*sources.query,
                   scope.replay ? scope.replay->recorded_frames : scope.query_frames, "the query");
  // References of FAB-MAP are places: the data set's training sequences are not.
  if (evaluation.result && evaluation.result->result.places) dataset.reset();
  sources.references = open_references(find_train(inputs, dataset), scope);
  return sources;
}

}  // namespace

void add_picture_options(const Command& app, PictureInputs& inputs) {
  const std::string group = "Pictures";
  app.add_option("--html", inputs.html,
                 "write a report with pictures: one file that opens anywhere, without a network; a "
                 "result is shown without a ground truth, too")
      .group(group)
      .type_name("FILE");
  app.add_option("--plot", inputs.plots,
                 "draw curves, timeline and matrix as SVG and PNG into this folder")
      .group(group)
      .type_name("FOLDER");
  app.add_option("--query", inputs.query,
                 "the query's frames for --html: a sequence, or its name in the data set")
      .group(group)
      .type_name("SEQUENCE");
  app.add_list("--train", inputs.train,
               "a training sequence for --html; repeat it in the order of the database")
      .group(group)
      .type_name("SEQUENCE");
}

bool wants_pictures(const PictureInputs& inputs) {
  return !inputs.html.empty() || !inputs.plots.empty();
}

void check_picture_outputs(const Session& session, const PictureInputs& inputs) {
  if (!inputs.html.empty()) session.outputs.claim_file(inputs.html);
  if (!inputs.plots.empty()) session.outputs.claim_folder(inputs.plots, is_marked_folder);
}

void write_pictures(Session& session, const PictureInputs& inputs, const std::string& dataset,
                    const Evaluation& evaluation, const Json& report, const std::string& summary) {
  const ScoreMatrix* matrix = evaluation.matrix ? &*evaluation.matrix : nullptr;
  if (!inputs.html.empty()) {
    const FrameSources sources = find_frames(inputs, dataset, evaluation);
    const std::string page = html_report(report, summary, evaluation.judgement, evaluation.truth,
                                         matrix, sources, session.monitor);
    session.outputs.file(inputs.html).write(page);
  }
  if (inputs.plots.empty()) return;
  draw_evaluation(report, evaluation.judgement, evaluation.truth, matrix,
                  session.outputs.folder(inputs.plots, is_marked_folder).temporary(),
                  session.monitor);
}

}  // namespace vpr
