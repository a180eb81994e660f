// --expect, --update and --junit of vpr-eval.
#pragma once

#include <string>
#include <vector>

#include "common/command.h"
#include "evaluation/expectation.h"

namespace vpr {

struct ExpectInputs {
  std::string expected;  ///< a file; empty: nothing is expected
  bool update = false;   ///< the file takes over what is found
  std::string junit;     ///< a file; empty: not asked for

  bool any() const { return update || !expected.empty() || !junit.empty(); }
};

void add_expect_options(const Command& app, ExpectInputs& inputs);

/// Reads what is expected, and claims what is written; null where nothing is. Throws Error(usage)
/// for --update or --junit without --expect, and Error(input) for a file that can't be read, unless
/// --update makes it. Call it before long work.
Json read_expected(const Session& session, const ExpectInputs& inputs);

/// The values that are expected, compared with the report. Writes what is asked for.
std::vector<CheckedValue> check_expected(const Session& session, const ExpectInputs& inputs,
                                         const Json& expected, const Json& report);

/// "expected.json: all 12 expected values are met."; nothing where nothing is expected.
std::string met_sentence(const ExpectInputs& inputs, const std::vector<CheckedValue>& values);

/// Throws Error(expectation) with a line for each value that is not met, unless it was updated.
void require_met(const ExpectInputs& inputs, const std::vector<CheckedValue>& values);

}  // namespace vpr
