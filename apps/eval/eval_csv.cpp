#include "eval_csv.h"

#include "base/error.h"
#include "report/outcome_csv.h"

namespace vpr {

CsvRows::CsvRows() : outcomes(outcomes_csv_header()), recognitions(recognitions_csv_header()) {}

void add_csv_options(const Command& app, CsvInputs& inputs) {
  app.add_option("--outcomes-csv", inputs.outcomes,
                 "write a row for every query: its best match and whether that is right")
      .type_name("FILE");
  app.add_option("--recognitions-csv", inputs.recognitions,
                 "write a row for every recognised place: frames, hits and whether it is right")
      .type_name("FILE");
}

void claim_csv_outputs(const Session& session, const CsvInputs& inputs, bool has_result) {
  if (!inputs.outcomes.empty()) session.outputs.claim_file(inputs.outcomes);
  if (inputs.recognitions.empty()) return;
  session.outputs.claim_file(inputs.recognitions);
  if (!has_result)
    throw Error(ErrorKind::usage,
                "--recognitions-csv lists the recognitions of a result of vpr-query; scores have "
                "--outcomes-csv");
}

void add_rows(CsvRows& rows, const CsvInputs& inputs, const Evaluation& evaluation,
              const std::string& name) {
  if (!inputs.outcomes.empty())
    rows.outcomes += outcomes_csv(evaluation.judgement, name, evaluation.query_name);
  if (!inputs.recognitions.empty() && evaluation.result)
    rows.recognitions += recognitions_csv(*evaluation.result, name);
}

void write_csv_rows(const Session& session, const CsvInputs& inputs, const CsvRows& rows) {
  if (!inputs.outcomes.empty()) session.outputs.file(inputs.outcomes).write(rows.outcomes);
  if (!inputs.recognitions.empty())
    session.outputs.file(inputs.recognitions).write(rows.recognitions);
}

}  // namespace vpr
