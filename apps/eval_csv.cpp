#include "eval_csv.h"

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

void check_csv_outputs(const Session& session, const CsvInputs& inputs, bool has_result) {
  const Existing existing = session.options.existing();
  if (!inputs.outcomes.empty()) check_output_file(inputs.outcomes, existing);
  if (inputs.recognitions.empty()) return;
  check_output_file(inputs.recognitions, existing);
  if (!has_result)
    throw Error(ErrorKind::usage,
                "--recognitions-csv lists the recognitions of a result of vpr-query; scores have "
                "--outcomes-csv");
}

void add_rows(CsvRows& rows, const CsvInputs& inputs, const Evaluation& evaluation,
              const std::string& name) {
  if (!inputs.outcomes.empty())
    rows.outcomes +=
        outcomes_csv(evaluation.judgement, name, evaluation.report["query"].get<std::string>());
  rows.recognitions += evaluation.recognitions;
}

void write_csv_rows(const Session& session, const CsvInputs& inputs, const CsvRows& rows) {
  const Existing existing = session.options.existing();
  if (!inputs.outcomes.empty()) write_file(inputs.outcomes, rows.outcomes, existing);
  if (!inputs.recognitions.empty()) write_file(inputs.recognitions, rows.recognitions, existing);
}

}  // namespace vpr
