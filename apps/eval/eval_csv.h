// --outcomes-csv and --recognitions-csv of vpr-eval.
#pragma once

#include <string>

#include "common/command.h"
#include "pipeline/evaluate.h"

namespace vpr {

struct CsvInputs {
  std::string outcomes;  ///< files; empty: not asked for
  std::string recognitions;

  bool any() const { return !outcomes.empty() || !recognitions.empty(); }
};

/// Rows of one result or several, below one header.
struct CsvRows {
  CsvRows();
  std::string outcomes;
  std::string recognitions;
};

void add_csv_options(const Command& app, CsvInputs& inputs);

/// Claims the outputs. Throws Error(usage) for recognitions where there is no result.
/// Call it before long work.
void claim_csv_outputs(const Session& session, const CsvInputs& inputs, bool has_result);

/// Adds the rows that are asked for.
void add_rows(CsvRows& rows, const CsvInputs& inputs, const Evaluation& evaluation,
              const std::string& name);

void write_csv_rows(const Session& session, const CsvInputs& inputs, const CsvRows& rows);

}  // namespace vpr
