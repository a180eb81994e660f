#include "query/result_file.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/json_schema.h"
#include "base/mapped_file.h"
#include "base/provenance.h"
#include "database/archive.h"
#include "query/choices.h"
#include "recordings/sequence_json.h"

namespace vpr {

template <class Visitor>
void visit_fields(UsedStatistics& statistics, Visitor&& visit) {
  visit_fields(statistics.settings, visit);
  visit("typical_distance", statistics.typical_distance, "Mean distance of frames.", at_least(0));
}

VPR_FIELDS(SearchRecall, (windows, "Windows with a match."), (found_best, "Best ones found."),
           (recognitions, "Recognitions of exact search."),
           (found_recognitions, "Recognitions that were found."))

namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostFrames = std::numeric_limits<int32_t>::max();

struct ResultContent {
  Result& result;
  ResultContext& context;

  bool has_places() const { return std::holds_alternative<FabmapQuerySettings>(result.settings); }
};

/// Windows of a cluster in one sequence, and their frames.
struct ClusterSpan {
  size_t window = 0, anchor = 0, first = 0, last = 0, first_frame = 0, last_frame = 0;
};
VPR_FIELDS(ClusterSpan, (window, "Mean window of recognitions."), (anchor, "Its last frame."),
           (first, "First window with a recognition."), (last, "Last window with a recognition."),
           (first_frame, "First frame covered."), (last_frame, "Last frame covered."))

struct StoredCluster {
  size_t sequence = 0;
  ClusterSpan query, train;
  size_t recognitions = 0;
  int64_t best_score = 0;
};
VPR_FIELDS(StoredCluster, (sequence, "Index of the training sequence."),
           (query, "Windows of the query."), (train, "Windows of the sequence."),
           (recognitions, "Recognitions of the cluster."),
           (best_score, "Smallest summed score of its recognitions."))

std::vector<StoredCluster> stored_clusters(const Clusters& clusters, size_t length) {
  const auto span = [&](size_t window, size_t first, size_t last) -> ClusterSpan {
    return {window, anchor_of(window, length), first, last, first, anchor_of(last, length)};
  };
  std::vector<StoredCluster> stored;
  for (const Cluster& one : clusters.all)
    stored.push_back({one.sequence, span(one.query_window, one.query_first, one.query_last),
                      span(one.train_window, one.train_first, one.train_last), one.recognitions,
                      static_cast<int64_t>(one.best_score)});
  return stored;
}

/// A sum of scores, which is smaller in files by `offset`.
auto sum_field(uint32_t& sum, int64_t offset) {
  return CustomField{
      [&sum, offset](Json& json, const std::string& key) { json[key] = sum - offset; },
      [&sum, offset](const Fields& fields, const std::string& key) {
        constexpr int64_t kMost = int64_t{1} << 33;  // above any sum; the addition cannot overflow
        int64_t number = 0;
        fields.read(key, number);
        if (number <= -kMost || number >= kMost || !std::in_range<uint32_t>(number + offset))
          fields.fail(fmt::format("\"{}\" is out of range", key));
        sum = static_cast<uint32_t>(number + offset);
      }};
}

template <class Visitor>
void visit_query(ResultContent& content, Visitor&& visit) {
  Result& result = content.result;
  visit_sequence(result.query, visit, [&] {
    visit("windows", result.query_windows,
          "Matched windows: frames - c_l + 1; in FAB-MAP the frames.");
    visit("unreadable", result.query.unreadable, kUnreadableText);
  });
  if (content.has_places())
    visit("featureless", result.places->featureless,
          "Frames without visual words, never recognized.");
}

template <class Visitor>
void visit_compared(ComparedSequence& compared, ResultContent& content, Visitor&& visit) {
  visit_sequence(compared.sequence, visit, [&] {
    visit("windows", compared.windows, "Windows without undecodable frames; in FAB-MAP places.");
    visit("searched", compared.searched, "Selected by --only-sequence.");
  });
  if (!compared.searched || content.has_places()) return;
  visit("t_r", compared.threshold, "Threshold on t_r_scale; null: none; absent if not searched.",
        kMayBeMissing);
  visit("t_r_scale", compared.scale, "Scale of t_r.", kMayBeMissing);
  visit("limit",
        sum_field(compared.distance_limit,
                  content.result.score().offset(content.result.window_length())),
        "Recognitions have a smaller summed score: bits, or 1/1024 standard deviations.",
        kAs<int64_t>, kMayBeMissing);
  visit("max_distance", IfSet{compared.max_distance}, "Largest distance.");
  visit("margin", IfSet{compared.margin},
        "Required margin in this sequence, in score per frame; absent if decide is threshold.",
        at_least(0));
}

template <class Visitor>
void visit_context(ResultContext& context, Visitor&& visit) {
  RunInfo& run = context.run;
  visit("provenance", NestedObject{[&](auto&& inner) {
          visit_origin(inner, run.program, Derived{program_version()}, Derived{program_commit()});
          inner("seed", run.seed, "Seed of random choices.");
          inner("database", context.database_fingerprint, "Checksum of the database.", kIsChecksum);
          inner("query", context.query_fingerprint, "Checksum of the query.", kIsChecksum);
        }},
        kProvenanceText);
  visit("machine",  // described by with_run
        CustomField{[&](Json& json, const std::string& key) { json[key] = machine_json(run); },
                    [&](const Fields& fields, const std::string& key) {
                      if (fields.has(key)) read_machine(fields.object(key), run);
                    }},
        "", kAs<Json>);
  visit("timing", Derived{timing_json(context.seconds)});
  // A saved matrix or posteriors are listed before the companions, arrays alone after them.
  const bool is_saved = context.files.count("matrix") + context.files.count("posteriors") > 0;
  if (is_saved) visit("files", context.files);
  visit("companions", Unless{context.companions, {}},
        "Checksums of the other files that vpr-query wrote into the folder of the result (a matrix "
        "or its image, posteriors, loop closures), by file name. A reader refuses the result while "
        "one of them belongs to another run.",
        kIsChecksum);
  if (!is_saved)
    visit("files", Unless{context.files, {}},
          "Arrays next to the result, by name, each with its rows and checksum "
          "(docs/reference/files.md). vpr-eval refuses others.");
}

template <class Visitor>
void visit_totals(Result& result, Visitor&& visit) {
  visit("recognitions", Derived{result.recognitions.size()}, "Accepted window pairs.");
  const auto of_path = [&](const char* name, std::optional<size_t> ResultPath::*count,
                           std::string_view text) {
    const auto write = [&](Json& json, const std::string& key) {
      if (result.path && (*result.path).*count) json[key] = *((*result.path).*count);
    };
    visit(name,
          CustomField{write,
                      [&](const Fields& fields, const std::string& key) {
                        std::optional<size_t> frames;
                        fields.read_if_set(key, frames);
                        if (!frames) return;
                        if (!result.path) result.path.emplace();
                        (*result.path).*count = frames;
                      }},
          text, kAs<size_t>, kMayBeMissing);
  };
  of_path("filter_keyframes", &ResultPath::keyframes,
          "Query frames that the filter compared with the places: its keyframes.");
  of_path("reversed_frames", &ResultPath::reversed_frames,
          "Query frames that the filter would recognize if the training sequences were in "
          "reverse order.");
  if (result.clusters)
    visit("clusters", Derived{result.clusters->all.size()}, "Recognized places.");
}

template <class Visitor>
void visit_fields(ResultContent& content, Visitor&& visit) {
  Result& result = content.result;
  ResultContext& context = content.context;
  visit("schema", Derived{schema_name("result")});
  visit("method", Derived{method_of(result.settings)}, "Matching method.");
  const auto write_settings = [&](Json& json, const std::string& key) {
    json[key] = settings_in_force(result.settings);
  };
  visit("settings",
        CustomField{write_settings,
                    [&](const Fields& fields, const std::string&) {
                      result.settings = read_query_settings(fields);
                      if (content.has_places()) result.places.emplace();
                    }},
        "Settings that can change the numbers; keys are the names of flags.",
        kAs<InForce<SequenceKeys>, InForce<FabmapQuerySettings>>);
  visit("statistics", IfSet{result.statistics},
        "Start of z-scores: distances of training frames from the rest of the training data.");
  visit("query", NestedObject{[&](auto&& inner) { visit_query(content, inner); }},
        "The query sequence.");
  visit(
      "sequences",
      NestedList{result.sequences, [&](ComparedSequence& compared,
                                       auto&& inner) { visit_compared(compared, content, inner); }},
      "The training sequences, in the order of the database; for FAB-MAP one, all places.");
  if (content.has_places())
    visit("places", NestedObject{[&](auto&& inner) {
            inner("names", result.places->names, "Place names.");
            inner("views", result.places->views, "Views of all places.");
          }},
          "Names of places by index, and the number of views; FAB-MAP only.");
  visit("totals", NestedObject{[&](auto&& inner) { visit_totals(result, inner); }}, "Totals.");
  visit("recall", IfSet{result.recall}, "Recall of an approximate method.");
  if (result.clusters)  // not for a reader, which finds them again
    visit("clusters", Derived{stored_clusters(*result.clusters, result.window_length())},
          "Recognized places: clusters of recognitions, by training sequence, then first "
          "recognition; for the method filter paths, by first recognition. Absent for FAB-MAP.");
  visit("matrix", IfSet{context.matrix}, "The shape of the matrix that --save-matrix wrote.");
  visit_context(context, visit);
}

// Checks what the types of fields do not imply.
void check_content(const Result& result, const JsonSource& source) {
  const size_t length = result.window_length();
  check_sequence(result.query, kMostFrames, source);
  if (result.query_windows != window_count(result.query.frames, length))
    source.fail("its numbers of windows and frames do not fit");
  for (const ComparedSequence& compared : result.sequences) {
    check_sequence(compared.sequence, kMostFrames, source);
    if (compared.windows > window_count(compared.sequence.frames, length))
      source.fail("\"windows\" is out of range");
  }
  if (!result.places) return;
  if (result.places->views > kMostFrames || result.places->featureless > result.query.frames)
    source.fail("\"places\" or \"featureless\" is out of range");
  if (result.sequences.size() != 1 ||
      result.sequences[0].sequence.frames != result.places->names.size())
    source.fail("its places and its sequences do not fit");
}

// Compares the clusters of the file with those of its recognitions.
void find_clusters(const Fields& fields, Result& result, const Monitor& monitor) {
  const int64_t eps = std::get<SequenceQuerySettings>(result.settings).clustering.eps;
  if (eps < 0 || eps > kMaxEps) fields.fail("its clustering.eps is out of range");
  cluster(result, monitor);
  if (fields.list("clusters") !=
      value_to_json(stored_clusters(*result.clusters, result.window_length()), kDataForm))
    fields.fail("its clusters are not those of its recognitions");
}

// Other files of the run in the folder of the result. They may be missing.
void check_companions(const fs::path& result, const ResultContext& context,
                      const JsonSource& source, const Monitor& monitor) {
  for (const auto& [name, sum] : context.companions) {
    if (fs::path(name).filename() != name)
      source.fail("\"companions\" is not a list of file names");
    const fs::path path = result.parent_path() / name;
    std::error_code error;
    if (fs::is_regular_file(path, error) && file_checksum(path, monitor) != sum)
      throw Error(ErrorKind::data,
                  "{}: belongs to another run than {}; run vpr-query again, with --force, or "
                  "remove this file",
                  path.string(), result.string());
  }
}

}  // namespace

void claim_result(const fs::path& path, Outputs& outputs) {
  if (path.extension() == ".npz")
    throw Error(ErrorKind::usage,
                "{}: is the name of the arrays. Use a name that ends with .json; the arrays are "
                "written next to it.",
                path.string());
  outputs.claim_file(path);
  outputs.claim_file(array_path(path));
}

void claim_over_result(const fs::path& path, Outputs& outputs) {
  outputs.claim_file(path);
  std::error_code error;
  if (fs::is_regular_file(path, error) &&
      read_file_start(path, 64).find("\"vpr.result/") != std::string::npos)
    outputs.claim_file(array_path(path));
}

std::string result_checksum(Json json) {
  for (const char* key : {"machine", "timing", "checksum"}) json.erase(key);
  return checksum(to_text(json));
}

Json result_json(const Result& result, const ResultContext& context) {
  return value_to_json(ResultContent{const_cast<Result&>(result),  // visited, not changed
                                     const_cast<ResultContext&>(context)},
                       kDataForm);
}

Json result_schema() {
  Result of_sequences, of_places;
  of_sequences.clusters.emplace();
  of_places.settings = FabmapQuerySettings{};
  of_places.places.emplace();
  ResultContext context;
  ResultContent first{of_sequences, context}, second{of_places, context};
  SchemaVisitor visit{SchemaForm::data, with_run(merged(field_schema(first, SchemaForm::data),
                                                        field_schema(second, SchemaForm::data)))};
  visit("checksum", std::string(), "Checksum of the content.", kIsChecksum, kMayBeMissing);
  visit.object["oneOf"] = {{{"required", {"clusters"}}}, {{"required", {"places"}}}};
  return visit.object;
}

Json write_result(const fs::path& path, const Result& result, ResultContext context,
                  Outputs& outputs) {
  for (const Output* file : outputs.files_next_to(path)) {
    const auto known = context.checksums.find(file->path());
    context.companions[file->path().filename().string()] =
        known != context.checksums.end() ? known->second : file_checksum(file->temporary());
  }
  write_arrays(result, context.files, &outputs.file(array_path(path)));
  Json json = result_json(result, context);
  json["checksum"] = result_checksum(json);
  outputs.file(path).write(to_text(json));
  return json;
}

Json read_result_json(const fs::path& path) {
  const std::string where = path.string();
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    throw Error(ErrorKind::data, "{}: is a {}. Pass a result of vpr-query (.json).", where,
                fs::exists(path / kManifestName, ignored) ? "database" : "folder");
  if (path.extension() == ".npz")
    throw Error(ErrorKind::data, "{}: holds the arrays of a result. Pass its .json file.", where);
  Json json = read_json(path, ErrorKind::data);
  require_schema(json, "result", where, ErrorKind::data);
  const Fields fields(json, where);
  if (fields.text("checksum") != result_checksum(json)) fields.fail("its checksum does not fit");
  return json;
}

QuerySettings read_query_settings(const Fields& file) {
  if (FabmapQuerySettings places; file.text("method") == places.method) {
    file.read_settings("settings", places);
    return places;
  }
  SequenceKeys keys;
  keys.witness = Witness::none;  // of files without it, which were written before it was
  file.read_settings("settings", keys);
  const std::string& method = keys.windows.windows.method;
  if (std::ranges::count(sequence_methods(), method, &SequenceMethod::name) == 0)
    file.fail(fmt::format("the method \"{}\" is unknown", method));
  SequenceQuerySettings settings = query_of(keys);
  try {
    check_settings(settings);
  } catch (const Error& error) {
    file.fail(error.what());
  }
  return settings;
}

StoredResult read_result(const fs::path& path, const Monitor& monitor) {
  const Json json = read_result_json(path);
  const Fields fields(json, path.string());
  const JsonSource& source = fields.source();
  StoredResult stored;
  auto& [result, context, fingerprint] = stored;
  fingerprint = fields.text("checksum");
  ResultContent content{result, context};
  value_from_json(json, content, source, "result");
  check_content(result, source);
  read_arrays(path, context.files, source, result);
  if (!content.has_places()) find_clusters(fields, result, monitor);
  check_companions(path, context, source, monitor);
  return stored;
}

std::string fingerprint_of(const StoredResult& stored) {
  ResultContext context = stored.context;
  write_arrays(stored.result, context.files, nullptr);
  return result_checksum(result_json(stored.result, context));
}

}  // namespace vpr
