#include "session.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"
#include "base/text.h"
#include "present/result_file.h"
#include "progress.h"
#include "sequence/sequence_source.h"
#include "store/archive.h"
#include "truth/dataset.h"

namespace vpr {

namespace {

// Throws Error(output).
void write_to_stdout(const std::string& text) {
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written)
    throw Error(ErrorKind::output,
                fmt::format("standard output: can't be written: {}", system_error_text(errno)));
}

// Scripts get what names hold; on a terminal they are only shown.
void print_json(ProgressLine& progress, const std::string& text) {
  progress.clear();
  write_to_stdout(::isatty(STDOUT_FILENO) != 0 ? printable(text) : text);
}

namespace fs = std::filesystem;

constexpr std::array kOutputs = {
    "output",      "save-matrix", "save-posteriors", "html",         "plot",
    "map",         "heat-map",    "save-config",     "outcomes-csv", "recognitions-csv",
    "descriptors", "junit",       "fixes-tum",       "pairs",        "save-loops"};

bool has_name(const GivenFlag& flag, const char* name) {
  return std::ranges::find(flag.names, name) != flag.names.end();
}

/// Collects paths that exist; what can't be read is the command's to complain of.
struct Inputs {
  std::vector<fs::path> paths;

  bool add(const fs::path& path) {
    std::error_code error;
    if (path.empty() || !fs::exists(path, error)) return false;
    paths.push_back(path);
    return true;
  }

  void add_files(const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error))
      paths.push_back(entry->path());
  }

  // Of a folder with other things in it, only the frames are read.
  void add_sequence(const SequenceArgument& argument) {
    std::error_code error;
    const bool is_list = argument.path.extension() == ".txt" || argument.path.extension() == ".lst";
    if (!add(argument.path) || !(is_list || fs::is_directory(argument.path, error))) return;
    if (fs::exists(argument.path / kManifestName, error)) return add_files(argument.path);
    try {
      for (const fs::path& frame : open_sequence(argument).files) paths.push_back(frame);
    } catch (const Error&) {
    }
  }

  void add_truth(const std::optional<GroundTruthArgument>& truth) {
    if (!truth) return;
    add(truth->path);
    GroundTruthOptions options = truth->options;
    visit_paths(options, [&](const char*, const fs::path& path) { add(path); });
  }

  void add_dataset(const fs::path& path) {
    Dataset dataset;
    try {
      dataset = read_dataset(path);
    } catch (const Error&) {
      return;
    }
    for (const SequenceArgument& sequence : dataset.pretrain) add_sequence(sequence);
    for (const DatasetPlace& place : dataset.places)
      for (const SequenceArgument& view : place.views) add_sequence(view);
    for (const DatasetQuery& query : dataset.queries) {
      dataset.train.push_back(query.sequence);
      add_truth(query.sequence_ground_truth);
      add_truth(query.place_ground_truth);
    }
    for (const NamedSequence& sequence : dataset.train) {
      add_sequence(sequence.sequence);
      add(sequence.poses);
    }
    add(dataset.plan);
    add(dataset.place_poses);
  }

  // PATH, PATH@RANGE, NAME=PATH or NAME=PATH@RANGE.
  void add_value(const std::string& value) {
    std::error_code error;
    const size_t equals = value.find('=');
    const bool has_name = equals != std::string::npos && !fs::exists(value, error);
    SequenceArgument argument;
    try {
      argument = parse_sequence_argument(has_name ? value.substr(equals + 1) : value);
    } catch (const Error&) {
      return;
    }
    add_sequence(argument);
    if (argument.path.extension() == ".json")
      for (const char* kind : kResultArrays) add(companion_path(argument.path, kind));
  }
};

}  // namespace

void Session::print(const std::string& text) const {
  progress.clear();
  write_to_stdout(printable(text));
}

void Session::print_line(const Json& json) const { print_json(progress, to_line(json) + "\n"); }

void Session::claim_output() const {
  if (!options.output.empty()) outputs.claim_file(options.output);
}

void Session::write_output(const Json& json) const {
  if (!options.output.empty()) outputs.file(options.output).write(to_text(json));
}

void Session::print_result(const std::string& text, const Json& json) const {
  const bool has_files = outputs.has_outputs();
  outputs.commit();
  try {
    if (options.json)
      print_json(progress, to_text(json));
    else if (!options.quiet)
      print(text);
  } catch (const Error& error) {
    if (!has_files) throw;
    const std::string sentence =
        fmt::format("{}; the output files are complete", std::string(error.what()));
    if (options.json) throw Error(error.kind(), sentence);
    warn(monitor, sentence);
  }
}

std::vector<fs::path> run_inputs(const std::vector<GivenFlag>& given) {
  Inputs inputs;
  for (const GivenFlag& flag : given) {
    if (std::ranges::any_of(kOutputs, [&](const char* name) { return has_name(flag, name); }))
      continue;
    for (const std::string& value : flag.values) {
      if (has_name(flag, "dataset")) inputs.add_dataset(value);
      inputs.add_value(value);
    }
  }
  return inputs.paths;
}

}  // namespace vpr
