// The calls of the libraries for C++ (vpr/vpr.h) and Python: each reads its settings by name, runs
// the steps of one program, and returns in memory what the program writes. Callers hold a
// ProcessTurn.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/json.h"
#include "base/npy.h"
#include "evaluate/report.h"
#include "evaluate/score_matrix.h"
#include "fabmap/database.h"
#include "query/choices.h"
#include "query/live_lines.h"
#include "query/result_file.h"
#include "query/sequence_query.h"
#include "recordings/frames.h"

namespace vpr::calls {

/// The settings of a call by JSON key, such as "c_l".
struct Keywords {
  std::string function;  ///< names itself in errors
  Json values;
  ProcessSettings process = {};

  /// Reads the settings of the process. Throws Error(usage) for wrong values.
  Keywords(std::string name, Json given);

  /// Reads all values as these settings and those of the process. Throws Error(usage) for wrong
  /// values, and for other keys, with the nearest name.
  template <class... S>
  void read(S&... settings) {
    NestedObject all{[&](auto&& visit) {
      visit_fields(process, visit);
      (visit_fields(settings, visit), ...);
    }};
    value_from_json(values, all, function, "the settings");
  }
};

/// Calls of several threads run one after the other, because settings of libraries belong to the
/// process. Waits for the turn of this call, then applies its settings until the end of its
/// lifetime. Throws Error(interrupted) if the user wants to stop, and as ProcessScope does.
class ProcessTurn {
 public:
  ProcessTurn(const ProcessSettings& settings, const Monitor& monitor);

 private:
  std::unique_lock<std::timed_mutex> lock_;
  ProcessScope scope_;
};

struct Database {
  AnyDatabase content;  ///< queries add what they compute once, such as statistics
  std::string path;     ///< from which it was read; empty: trained by this process

  /// Throws Error(data) for FAB-MAP.
  SequenceDatabase& sequences();
  /// Names of the training sequences.
  std::vector<std::string> names() const;
};
using DatabasePointer = std::shared_ptr<Database>;
using ResultPointer = std::shared_ptr<StoredResult>;

/// Views an array in memory, whose name is for messages.
using ArrayView = std::function<std::shared_ptr<const NpyArray>(const std::string& name)>;

/// Frames: a path as on the command line, or an array of descriptors.
struct Frames {
  std::string name;  ///< may be empty
  std::variant<std::filesystem::path, ArrayView> source;
};

/// Sequences with their names. Without one, it is the name of the path, or `array_name`, with a
/// number if there are several sequences. Throws as parse_sequence_argument and sequence_names do.
std::vector<NamedArgument> named_arguments(const std::vector<Frames>& frames,
                                           const std::string& array_name);

/// As vpr-train images and descriptors or, with pretraining sequences, vpr-train fabmap.
DatabasePointer train(Keywords& keywords, std::vector<NamedArgument> sequences,
                      const std::vector<SequenceArgument>& pretrain, const Monitor& monitor);
DatabasePointer read_database(const std::filesystem::path& path);

/// As `command` of vpr-query: query or loops. `database`: null for windows of loops and for
/// matrices. Only the query and the scores of `inputs` are used.
ResultPointer query(Keywords& keywords, QueryCommand command, const DatabasePointer& database,
                    QueryInputs inputs, const Monitor& monitor);

/// As vpr-query live.
class Live {
 public:
  /// Throws as query does, and as LiveLines.
  Live(Keywords& keywords, const DatabasePointer& database, const Monitor& monitor);

  /// Whether frames are arrays of descriptors.
  bool has_arrays() const;
  /// As LiveLines. Throws Error(usage) after finish.
  std::optional<LiveAnswer> take(const LiveFrame& frame, const Monitor& monitor);
  std::optional<LiveAnswer> finish();
  const LiveLines& lines() const { return *lines_; }

 private:
  std::string function_;
  std::shared_ptr<const SequenceDatabase> sequences_;
  std::optional<LiveLines> lines_;
  bool is_finished_ = false;
};

/// An evaluation, with its report.
struct Judged {
  Evaluation evaluation;
  Report report;
  std::shared_ptr<const StoredResult> stored;  ///< null: scores
  RunInfo run;
  double seconds = 0;

  /// The report file.
  std::string text() const { return to_text(report_json(report, run, seconds)); }
  std::string summary() const;
};

/// As vpr-eval: judges a result or, if it is null, scores. `truth`: nullopt for none; its path, as
/// `truth_text`, is part of the report.
std::shared_ptr<Judged> evaluate(Keywords& keywords,
                                 const std::shared_ptr<const StoredResult>& result,
                                 ScoreInput scores, const std::optional<GroundTruthArgument>& truth,
                                 const std::string& truth_text, const Monitor& monitor);

/// Runs `write`, and commits its outputs, which replace no input of the run. `replace`: outputs
/// that exist.
void save(bool replace, const RunInfo& run, const std::function<void(Outputs& outputs)>& write);
/// Write the folder of vpr-train, and the result file of vpr-query and its arrays. Throw as Outputs
/// do, and Error(usage) for a result that was read from a file.
void save(const Database& database, const std::filesystem::path& path, bool replace);
void save(const StoredResult& result, const std::filesystem::path& path, bool replace);

}  // namespace vpr::calls
