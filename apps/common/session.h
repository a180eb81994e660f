// What a command gets to work with: common flags, progress, outputs, and where results are printed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/monitor.h"
#include "base/output.h"
#include "match/row_kernels.h"
#include "parser.h"
#include "present/run_info.h"
#include "sequence/decode.h"

namespace vpr {

struct CommonOptions {
  std::string output;
  std::string config;
  std::vector<std::string> config_keys;  ///< that the configuration gives values for
  uint64_t threads = 0;                  ///< 0: all cores
  uint64_t seed = 1;
  uint64_t max_megapixels = kUsualMegapixels;
  bool quiet = false;
  bool verbose = false;
  bool force = false;
  bool json = false;

  Existing existing() const { return force ? Existing::replace : Existing::refuse; }
};

/// Keys of a configuration file that are no settings of a method.
template <class Visitor>
void visit_fields(CommonOptions& options, Visitor&& visit) {
  visit("threads", options.threads);
  visit("seed", options.seed);
  visit("max_megapixels", options.max_megapixels);
}

class ProgressLine;

/// What a command gets to work with.
struct Session {
  const CommonOptions& options;
  const Monitor& monitor;
  RunInfo run;
  RowKernels kernels;
  ProgressLine& progress;
  Outputs& outputs;

  /// Claims the file of --output, where it is given.
  void claim_output() const;
  /// Fills it with a JSON.
  void write_output(const Json& json) const;
  /// Prints to stdout, where a progress line has been before, what a terminal may show
  /// (printable); Error(output) if that fails (a full disk, a closed pipe).
  void print(const std::string& text) const;
  /// Prints a JSON on a line of its own, whole; Error(output) as print does.
  void print_line(const Json& json) const;
  /// Commits the outputs of the run, and then prints a readable text, or with --json the JSON;
  /// neither with --quiet (but --json always). Where files are written, a text that can't be
  /// printed is a warning, for all that was asked for is there.
  void print_result(const std::string& text, const Json& json) const;
};

/// Every value of an option or argument that names something that exists, but for options that
/// name outputs; sequences with their frames, databases with their files, results with their
/// companions, and data sets with the files that they name.
std::vector<std::filesystem::path> run_inputs(const std::vector<GivenFlag>& given);

}  // namespace vpr
