// Score matrices: reading them, ranks, best matches, and the curve over all pairs.
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "evaluate/judgment.h"
#include "evaluate/metrics.h"
#include "support.h"

using namespace vpr;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::filesystem::path write_raw(const std::string& type, const std::string& shape, bool is_fortran,
                                const std::string& bytes) {
  std::string text = "{'descr': '" + type +
                     "', 'fortran_order': " + (is_fortran ? "True" : "False") +
                     ", 'shape': " + shape + ", }";
  text.resize(117, ' ');
  text += '\n';
  test::write_text("s.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + text + bytes);
  return "s.npy";
}

template <class T>
std::filesystem::path write_matrix(const std::vector<T>& values, size_t rows, size_t cols) {
  test::write_array<T>("s.npy", values, {rows, cols});
  return "s.npy";
}

std::vector<std::vector<double>> all_scores(const ScoreMatrix& matrix) {
  std::vector<std::vector<double>> rows(matrix.queries);
  matrix.for_each_row(2, {}, "", [&](size_t, size_t query, std::span<const uint64_t> keys) {
    for (const uint64_t key : keys) rows[query].push_back(score_of_key(key, matrix.kind));
  });
  return rows;
}

GroundTruth truth_of(size_t queries, const std::vector<std::array<int, 3>>& pairs) {
  GroundTruth truth;
  truth.pairs.resize(queries);
  for (const auto& [query, reference, ignore] : pairs)
    truth.pairs[size_t(query)].push_back(
        {0, uint32_t(reference), ignore != 0 ? PlaceLabel::ignore : PlaceLabel::same});
  return truth;
}

MatrixScan scan(const std::filesystem::path& path, const GroundTruth& truth,
                ScoreFormat format = {}) {
  const ScoreMatrix matrix(path, format);
  return scan_matrix(matrix, truth, layout_of(matrix, 1), {});
}

}  // namespace

TEST_CASE("scores of every type are read exactly") {
  const auto read = [&](const std::string& type, const std::string& bytes) {
    return all_scores(ScoreMatrix(write_raw(type, "(1, 2)", false, bytes), {}))[0];
  };
  using Row = std::vector<double>;
  CHECK(read("|u1", std::string("\x02\xff", 2)) == Row{2, 255});
  CHECK(read("|i1", std::string("\x02\xff", 2)) == Row{2, -1});
  CHECK(read("|b1", std::string("\x00\x01", 2)) == Row{0, 1});
  CHECK(read("<u2", std::string("\x02\x00\xff\xff", 4)) == Row{2, 65535});
  CHECK(read("<i2", std::string("\x02\x00\xff\xff", 4)) == Row{2, -1});
  CHECK(read("<i8", std::string("\x02\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff", 16)) ==
        Row{2, -1});
  CHECK(read("<u8", std::string("\x02\0\0\0\0\0\0\0\0\0\0\0\1\0\0\0", 16)) == Row{2, 4294967296.0});
  // Half precision: 1.0 and -2.5; the smallest above 0 and infinity.
  CHECK(read("<f2", std::string("\x00\x3c\x00\xc1", 4)) == Row{1, -2.5});
  CHECK(read("<f2", std::string("\x01\x00\x00\x7c", 4)) == Row{std::ldexp(1.0, -24), INFINITY});
  CHECK(std::isnan(read("<f2", std::string("\x01\x7e\x00\x3c", 4))[0]));
  CHECK(all_scores(ScoreMatrix(write_matrix<double>({0.1, kNan}, 1, 2), {}))[0][0] == 0.1);
  CHECK(all_scores(ScoreMatrix(write_matrix<float>({0.1F, 2}, 1, 2), {}))[0][0] == double{0.1F});
}

TEST_CASE("C and Fortran order, queries or references first, have their documented meaning") {
  const std::string bytes = {1, 2, 3, 4, 5, 6};
  const auto read = [&](bool is_fortran, bool train_first) {
    ScoreFormat format;
    format.train_first = train_first;
    return all_scores(ScoreMatrix(write_raw("|u1", "(2, 3)", is_fortran, bytes), format));
  };
  using Rows = std::vector<std::vector<double>>;
  CHECK(read(false, false) == Rows{{1, 2, 3}, {4, 5, 6}});
  CHECK(read(true, false) == Rows{{1, 3, 5}, {2, 4, 6}});
  CHECK(read(false, true) == Rows{{1, 4}, {2, 5}, {3, 6}});
  CHECK(read(true, true) == Rows{{1, 2}, {3, 4}, {5, 6}});
}

TEST_CASE("invalid score matrices are refused") {
  const auto kind = [&](const std::string& type, const std::string& shape, size_t bytes) {
    return test::error_kind([&] {
      all_scores(ScoreMatrix(write_raw(type, shape, false, std::string(bytes, '\x7f')), {}));
    });
  };
  CHECK(kind("|u1", "(4,)", 4) == ErrorKind::data);
  CHECK(kind("|u1", "(2, 2, 1)", 4) == ErrorKind::data);
  CHECK(kind("<c8", "(2, 2)", 32) == ErrorKind::data);
  CHECK(kind("|O8", "(1, 1)", 8) == ErrorKind::data);
  CHECK(kind(">f4", "(1, 1)", 4) == ErrorKind::data);
  CHECK(kind("<i8", "(1, 1)", 8) == ErrorKind::data);  // beyond 2^53
  CHECK(kind("|u1", "(2, 2)", 4) == std::nullopt);
  CHECK(kind("|u1", "(0, 2)", 0) == ErrorKind::data);
  CHECK(kind("|u1", "(2, 0)", 0) == ErrorKind::data);
}

TEST_CASE("ranks and best matches of a small matrix equal those counted by hand") {
  // Correct references: 1 | 3 (tied with 0 and 2) | none | 0 (no score) | 0, with 1 ignored.
  const std::vector<double> scores = {5,    1,    2,    3,     //
                                      4,    9,    4,    4,     //
                                      1,    kNan, kNan, kNan,  //
                                      kNan, 2,    3,    kNan,  //
                                      2,    1,    3,    4,     //
                                      kNan, kNan, kNan, kNan};
  const GroundTruth truth =
      truth_of(6, {{0, 1, 0}, {1, 3, 0}, {3, 0, 0}, {4, 0, 0}, {4, 1, 1}, {5, 0, 0}});
  const MatrixScan found = scan(write_matrix(scores, 6, 4), truth);
  const auto& queries = found.outcomes.queries;
  CHECK(queries[0].verdict == Verdict::correct);
  CHECK(queries[0].rank == 1);
  CHECK_FALSE(queries[0].is_tied);
  CHECK(queries[1].verdict == Verdict::incorrect);
  CHECK(queries[1].best == FrameMatch{0, 0});
  CHECK(queries[1].rank == 3);  // after the tied references 0 and 2
  CHECK(queries[1].is_tied);
  CHECK_FALSE(queries[2].has_match);
  CHECK(queries[2].verdict == Verdict::incorrect);
  CHECK_FALSE(queries[2].rank);
  CHECK(queries[3].verdict == Verdict::incorrect);
  CHECK_FALSE(queries[3].rank);
  CHECK(queries[4].verdict == Verdict::correct);  // the ignored reference is skipped
  CHECK(queries[4].rank == 1);
  CHECK(queries[5].verdict == Verdict::none);
  CHECK(found.pairs.curve.positives == 5);
  CHECK(found.pairs.same_without_score == 2);
  CHECK(found.pairs.ignored == 1);
  CHECK(*recall_at(found.outcomes, 1) == Approx(2 / 5.0));
  CHECK(*recall_at(found.outcomes, 2) == Approx(2 / 5.0));
  CHECK(found.outcomes.known_ranks == 2);  // of query 3; query 5 has none
  CHECK_FALSE(recall_at(found.outcomes, 3));
  const BestMatchCounts best = best_match_counts(found.outcomes);
  CHECK(best.frames == 5);
  CHECK(best.correct == 2);
  CHECK(best.incorrect == 2);
  CHECK(best.no_answer == 1);
  CHECK(best.without_match == 1);
  CHECK(std::ranges::count(found.outcomes.queries, true, &QueryOutcome::is_tied) == 1);
  const ScoreMatrix matrix(write_matrix(scores, 6, 4), ScoreFormat{});
  const auto answers = scan_matrix(matrix, truth, layout_of(matrix, 1), {}, false).outcomes.queries;
  CHECK(answers[4].verdict == Verdict::ignored);
  CHECK(answers[4].rank == 2);
}

TEST_CASE("a query without a match lowers precision, but is not a positive") {
  const MatrixScan found = scan(write_matrix<double>({2, 5, 1, 6}, 2, 2), truth_of(2, {{0, 0, 0}}));
  const Curve curve = single_best_curve(found.outcomes);
  CHECK(curve.positives == 1);
  REQUIRE(curve.points.size() == 2);
  CHECK(curve.points[0] == CurvePoint{score_key(1, ScoreOrder::distance), 0, 0, 1});
  CHECK(curve.points[1] == CurvePoint{score_key(2, ScoreOrder::distance), 1, 1, 1});
}

TEST_CASE("a value that marks a missing score is ignored") {
  ScoreFormat format;
  format.missing = -1;
  const auto path = write_matrix<int32_t>({-1, 5, 3, -1, -1, -1}, 2, 3);
  const MatrixScan found = scan(path, truth_of(2, {{0, 0, 0}, {1, 1, 0}}), format);
  CHECK(found.outcomes.queries[0].best == FrameMatch{0, 2});
  CHECK(found.outcomes.queries[1].verdict == Verdict::none);
}

TEST_CASE("a missing score is the nearest number of the file's type") {
  ScoreFormat format;
  format.missing = 0.1;
  const MatrixScan found =
      scan(write_matrix<float>({0.1F, 5, 3}, 1, 3), truth_of(1, {{0, 0, 0}}), format);
  CHECK(found.outcomes.queries[0].best == FrameMatch{0, 2});
}

TEST_CASE("windows of a matrix are evaluated at their anchors") {
  const ScoreMatrix matrix(write_matrix<double>({1, 2, 3, 4, 5, 6}, 2, 3), {});
  const ScoreLayout layout = layout_of(matrix, 4);
  CHECK(layout.scope.query.frames == 5);
  CHECK(layout.scope.sequences[0].sequence.frames == 6);
  const GroundTruth truth = truth_of(5, {{3, 3, 0}, {4, 1, 0}, {4, 5, 0}});
  const MatrixScan found = scan_matrix(matrix, truth, layout, {});
  REQUIRE(found.outcomes.queries.size() == 5);  // frames 0 to 2 end no window
  CHECK_FALSE(found.outcomes.queries[2].best);
  CHECK(found.outcomes.queries[3].best == FrameMatch{0, 3});
  CHECK(found.outcomes.queries[3].rank == 1);
  CHECK(found.outcomes.queries[4].rank == 3);
  CHECK(found.pairs.curve.positives == 3);  // of which reference 1 is not the anchor of a window
  CHECK(found.pairs.same_without_score == 1);
}

TEST_CASE("the labels of a row equal those of single pairs") {
  RandomEngine engine(4);
  const ScoreMatrix matrix(write_matrix<float>(std::vector<float>(8 * 24), 8, 24), {});
  ScoreLayout layout = layout_of(matrix, 3);
  layout.scope.sequences = {{{"a", 12}, true}, {{"b", 9}, false}, {{"c", 16}, true}};
  layout.columns = {{0, 0, 10}, {2, 10, 14}};
  for (int round = 0; round < 50; ++round) {
    GroundTruth truth;
    truth.tolerance_frames = int64_t(uniform_below(engine, 4));
    truth.pairs.resize(10);
    for (auto& pairs : truth.pairs)
      for (const uint32_t sequence : {0u, 2u})
        for (uint32_t reference = 0; reference < 12; ++reference)
          if (uniform_below(engine, 6) == 0)
            pairs.push_back(
                {sequence, reference,
                 uniform_below(engine, 2) == 0 ? PlaceLabel::same : PlaceLabel::ignore});
    std::vector<PlaceLabel> labels;
    for (size_t row = 0; row < 8; ++row) {
      label_row(truth, layout, row, labels);
      REQUIRE(labels.size() == 24);
      for (size_t column = 0; column < 24; ++column) {
        const FrameMatch match = match_of_column(layout, column);
        REQUIRE(labels[column] == truth.label(layout.anchor(row), match.sequence, match.reference));
      }
    }
  }
}

TEST_CASE("the curve over all pairs equals the curve of sorting all of them") {
  RandomEngine engine(11);
  for (int round = 0; round < 60; ++round) {
    const size_t rows = 1 + uniform_below(engine, 30);
    const size_t cols = 1 + uniform_below(engine, 30);
    const uint64_t values = round % 3 == 0 ? 3 : round % 3 == 1 ? 200 : 1000000000;
    std::vector<double> scores(rows * cols);
    for (double& score : scores)
      score =
          uniform_below(engine, 15) == 0 ? kNan : double(uniform_below(engine, values)) / 7 - 100;
    GroundTruth truth;
    truth.pairs.resize(rows);
    const uint64_t rarity = 1 + uniform_below(engine, 2 * cols);
    for (auto& pairs : truth.pairs)
      for (uint32_t reference = 0; reference < cols; ++reference)
        if (uniform_below(engine, rarity) == 0)
          pairs.push_back({0, reference,
                           uniform_below(engine, 4) == 0 ? PlaceLabel::ignore : PlaceLabel::same});
    for (const ScoreOrder kind : {ScoreOrder::distance, ScoreOrder::similarity}) {
      const ScoreMatrix matrix(write_matrix(scores, rows, cols),
                               {kind == ScoreOrder::similarity, false, {}});
      const ScoreLayout layout = layout_of(matrix, 1);
      const MatrixScan found = scan_matrix(matrix, truth, layout, {});
      std::vector<ScoredItem> items;
      uint64_t positives = 0;
      for (size_t q = 0; q < rows; ++q)
        for (size_t r = 0; r < cols; ++r) {
          const PlaceLabel label = truth.label(q, 0, r);
          if (label == PlaceLabel::ignore) continue;
          positives += label == PlaceLabel::same;
          items.push_back({score_key(scores[q * cols + r], kind), label == PlaceLabel::same});
        }
      sort_items(items);
      REQUIRE(found.pairs.curve == curve_of(items, positives, kind));
    }
  }
}

TEST_CASE("a large matrix yields the same result for any number of threads") {
  RandomEngine engine(12);
  std::vector<float> scores(700 * 5000);
  for (float& score : scores) score = float(uniform_below(engine, 5000));
  GroundTruth truth;
  truth.pairs.resize(700);
  truth.tolerance_frames = 2;
  for (uint32_t q = 0; q < 700; ++q) truth.pairs[q].push_back({0, 7 * q, PlaceLabel::same});
  const ScoreMatrix matrix(write_matrix(scores, 700, 5000), {});
  const ScoreLayout layout = layout_of(matrix, 1);
  std::optional<Curve> first;
  for (const size_t threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const Curve curve = scan_matrix(matrix, truth, layout, {}).pairs.curve;
    if (first) CHECK(curve == *first);
    first = curve;
    CHECK(curve.points.back().correct + curve.points.back().incorrect == 3500000);
  }
}

TEST_CASE("ranks of correct references equal those of sorting the row") {
  constexpr size_t kReferences = 300;
  RandomEngine engine(11);
  std::vector<float> values;
  for (size_t i = 0; i < 6 * kReferences; ++i)
    values.push_back(uniform_below(engine, 20) == 0 ? std::numeric_limits<float>::quiet_NaN()
                                                    : float(uniform_below(engine, 40)));
  std::vector<std::array<int, 3>> pairs;
  for (int query = 0; query < 5; ++query)  // the last query has no match
    for (int reference = 0; reference < int(kReferences); ++reference)
      if (const uint64_t kind = uniform_below(engine, 6); kind < 2)
        pairs.push_back({query, reference, int(kind)});
  const GroundTruth truth = truth_of(6, pairs);
  const MatrixScan found = scan(write_matrix<float>(values, 6, kReferences), truth);
  for (size_t query = 0; query < 6; ++query) {
    std::vector<std::pair<float, size_t>> order;
    std::vector<bool> is_right(kReferences);
    std::vector<bool> is_ignored(kReferences);
    for (const auto& pair : truth.pairs[query])
      (pair.label == PlaceLabel::same ? is_right : is_ignored)[pair.first] = true;
    for (size_t r = 0; r < kReferences; ++r)
      if (const float value = values[query * kReferences + r]; value == value && !is_ignored[r])
        order.emplace_back(value, r);
    std::sort(order.begin(), order.end());
    std::vector<uint8_t> expected;
    for (size_t rank = 1; rank <= kMaxRank; ++rank)
      if (is_right[order[rank - 1].second]) expected.push_back(static_cast<uint8_t>(rank));
    CHECK(found.outcomes.queries[query].correct_ranks == expected);
    CHECK(found.outcomes.queries[query].correct_count ==
          size_t(std::count(is_right.begin(), is_right.end(), true)));
  }
}
