#include "eval_expect.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "report/junit.h"

namespace vpr {

void add_expect_options(const Command& app, ExpectInputs& inputs) {
  app.add_option("--expect", inputs.expected,
                 "compare with a vpr.expected/1 file (numbers, with \"tolerance\", or \"min\" and "
                 "\"max\") or an earlier report; exit code 5 if they differ")
      .type_name("FILE");
  app.add_flag("--update", inputs.update,
               "the file of --expect takes over what is found (tolerances stay, and bounds that "
               "are met); where there is none, the report becomes it");
  app.add_option("--junit", inputs.junit,
                 "write what --expect finds as JUnit XML, a test case for each value")
      .type_name("FILE");
}

Json read_expected(const Session& session, const ExpectInputs& inputs) {
  if (inputs.expected.empty()) {
    if (inputs.update || !inputs.junit.empty())
      throw Error(ErrorKind::usage, fmt::format("{} needs --expect, the file of what is expected",
                                                inputs.update ? "--update" : "--junit"));
    return {};
  }
  if (!inputs.junit.empty()) session.outputs.claim_file(inputs.junit);
  std::error_code error;
  const bool exists = std::filesystem::exists(inputs.expected, error);
  const bool is_new = inputs.update && !exists;
  if (inputs.update) {
    if (!is_new) session.outputs.extend(inputs.expected);
    session.outputs.claim_file(inputs.expected);
  }
  if (!inputs.update && !exists)
    throw Error(ErrorKind::input, fmt::format("{}: no such file. With --update it is made from "
                                              "this report",
                                              inputs.expected));
  return is_new ? Json() : read_json(inputs.expected, ErrorKind::usage);
}

std::vector<CheckedValue> check_expected(const Session& session, const ExpectInputs& inputs,
                                         const Json& expected, const Json& report) {
  if (inputs.expected.empty()) return {};
  const Json& compared = expected.is_null() ? report : expected;
  std::vector<CheckedValue> values = check_expectations(report, compared, inputs.expected);
  if (!inputs.junit.empty()) {
    const std::string suite = fmt::format("{} on {}", report["method"].get<std::string>(),
                                          report["query"].get<std::string>());
    session.outputs.file(inputs.junit).write(junit_xml(suite, inputs.expected, values));
  }
  if (inputs.update) {
    const Json updated = updated_expectations(report, compared, inputs.expected);
    session.outputs.file(inputs.expected).write(to_text(updated));
  }
  return values;
}

std::string met_sentence(const ExpectInputs& inputs, const std::vector<CheckedValue>& values) {
  if (values.empty()) return "";
  const size_t unmet = unmet_expectations(values).size();
  if (unmet == 0)
    return fmt::format("\n{}: all of {} met.\n", inputs.expected,
                       counted(values.size(), "expected value is", "expected values are"));
  if (!inputs.update) return "";  // the error says it
  return fmt::format("\n{}: updated; {} of {} were not met.\n", inputs.expected, unmet,
                     counted(values.size(), "expected value"));
}

void require_met(const ExpectInputs& inputs, const std::vector<CheckedValue>& values) {
  const std::vector<std::string> unmet = unmet_expectations(values);
  if (!unmet.empty() && !inputs.update)
    throw Error(ErrorKind::expectation,
                fmt::format("{}: not met:\n  {}", inputs.expected, fmt::join(unmet, "\n  ")));
}

}  // namespace vpr
