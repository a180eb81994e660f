#include "present/evaluation_page.h"

#include <atomic>
#include <limits>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/metrics.h"
#include "evaluate/report.h"
#include "judgments.h"
#include "present/comparison_report.h"
#include "present/html_page.h"
#include "present/matrix_chart.h"
#include "recordings/sequence_source.h"
#include "support.h"

using namespace vpr;

namespace {

Judgment example(const std::string& letters, size_t window_length = 1) {
  return test::judgment_of(letters, window_length, {{{"ref", 40}}});
}

GroundTruth example_truth(const Judgment& judgment) {
  return read_ground_truth({"aligned", {}, 0}, judgment.layout.scope);
}

Evaluation evaluation_of(const Judgment& judgment, const GroundTruth& truth,
                         const std::string& method = "mine", const std::string& query = "walk") {
  Evaluation evaluation;
  evaluation.truth = truth;
  evaluation.judgment = judgment;
  evaluation.judgment.layout.scope.query.name = query;
  evaluation.scores = {method, {}, judgment.layout.window_length, {}};
  return evaluation;
}

std::vector<size_t> chosen(const std::vector<GalleryItem>& items, GalleryKind kind) {
  std::vector<size_t> queries;
  for (const GalleryItem& item : items)
    if (item.kind == kind) queries.push_back(item.query);
  return queries;
}

}  // namespace

TEST_CASE("text in a page can neither open an element nor end an attribute") {
  CHECK(html_escaped("<a href=\"x\" id='y'>&") ==
        "&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;");
  CHECK(html_escaped("a\x01z\xff") == "a\xef\xbf\xbdz\xef\xbf\xbd");
  CHECK(html_escaped("\xc3\xa4") == "\xc3\xa4");
}

TEST_CASE("data in a page cannot end its script") {
  CHECK(script_json(Json{{"a", "</script><!--"}}) == "{\"a\":\"\\u003c/script>\\u003c!--\"}");
}

TEST_CASE("base64 equals RFC 4648's examples") {
  const auto encode = [](const std::string& text) {
    return base64(std::as_bytes(std::span(text)));
  };
  CHECK(encode("").empty());
  CHECK(encode("f") == "Zg==");
  CHECK(encode("fo") == "Zm8=");
  CHECK(encode("foo") == "Zm9v");
  CHECK(encode("foobar") == "Zm9vYmFy");
  CHECK(encode("\xff\xfe") == "//4=");
}

TEST_CASE("inserted text is not expanded again") {
  CHECK(fill_page("a{{x}}b{{y}}c", {{"x", "{{y}}"}, {"y", "2"}}) == "a{{y}}b2c");
  CHECK(fill_page("a {{ b", {}) == "a {{ b");
}

TEST_CASE(
    "the gallery has the worst errors, and the best and weakest recognitions, along the path") {
  const Judgment judgment = example("cwwwwwwccccccccccccccccccccw");
  const auto items = choose_gallery(judgment, example_truth(judgment), 3);
  CHECK(chosen(items, GalleryKind::mistake) == std::vector<size_t>{1, 27, 2});
  CHECK(chosen(items, GalleryKind::recognition) == std::vector<size_t>{0, 10, 19});
  CHECK(chosen(items, GalleryKind::weak) == std::vector<size_t>{26, 18, 9});
  CHECK(items[0].truth == FrameMatch{0, 1});
  CHECK(choose_gallery(example(""), {}, 3).empty());
}

TEST_CASE("queries without a match have no true place in the gallery") {
  const Judgment judgment = example("w");
  GroundTruth truth;
  truth.pairs.resize(1);
  CHECK_FALSE(choose_gallery(judgment, truth, 3)[0].truth);
}

TEST_CASE("a strip ends at the anchor and covers the window") {
  CHECK(strip_frames(7, 1, 5) == std::vector<size_t>{7});
  CHECK(strip_frames(7, 3, 5) == std::vector<size_t>{5, 6, 7});
  CHECK(strip_frames(39, 40, 5) == std::vector<size_t>{0, 10, 20, 30, 39});
  CHECK(strip_frames(2, 40, 5) == std::vector<size_t>{0, 1, 2});
}

TEST_CASE("thumbnails are small, and unreadable frames are gaps") {
  const test::TemporaryFolder folder;
  test::write_image(folder / "1.png", 1, 400, 300);
  test::write_text(folder / "2.png", "no image");
  const SequenceSource sequence = open_sequence({folder.path(), {}});
  const auto found = make_thumbnails(sequence, {}, {0, 1, 9}, {100}, {});
  REQUIRE(found.size() == 2);
  CHECK(found.at(0).name == "1.png");
  const auto& bytes = found.at(0).jpeg;
  const cv::Mat image =
      cv::imdecode(cv::Mat(1, int(bytes.size()), CV_8UC1, const_cast<std::byte*>(bytes.data())),
                   cv::IMREAD_COLOR);
  CHECK(image.cols == 100);
  CHECK(image.rows == 75);
  CHECK(found.at(1).jpeg.empty());
}

TEST_CASE("a report is written again as it was read") {
  Judgment judgment = example("cwcwcw", 2);
  judgment.outcomes.queries[2].verdict = Verdict::none;
  judgment.outcomes.queries[2].best.reset();
  judgment.outcomes.queries[2].key = kNoScore;
  judgment.outcomes.queries[3].verdict = Verdict::ignored;
  judgment.outcomes.has_margins = judgment.outcomes.has_ranks = true;
  judgment.outcomes.queries[0].margin = 0.1;
  judgment.outcomes.queries[0].rank = 7;
  judgment.outcomes.queries[1].key =
      score_key(std::numeric_limits<double>::infinity(), ScoreOrder::distance);
  set_confidence(judgment, Confidence::margin);
  judgment.verdicts[2] = Verdict::correct;
  judgment.verdicts[3] = Verdict::ignored;
  judgment.localization = localize(judgment.verdicts, {});
  Evaluation evaluation = evaluation_of(judgment, example_truth(judgment));
  evaluation.scores.query.selection = at_speed("varying", 7, 3);
  evaluation.name = "mine";
  const Json json = report_json(report_of(evaluation, {}));
  CHECK(json["confidence"] == "margin");
  CHECK(json["outcomes"]["recognized"] == "..ri...");
  CHECK(report_json(parse_report(json, "r.json")).dump() == json.dump());
}

TEST_CASE("a selected query has the ground truth of its recording") {
  std::vector<Report> reports(2);
  reports[0].protocol.ground_truth = "aligned, training frames at speed 2";
  reports[1].protocol.ground_truth = "aligned, query at speed 0.5, training frames at speed 2";
  reports[1].selection.speed = "0.5";
  CHECK(compare_ground_truths(reports) == GroundTruths::same);
  reports[0].protocol.ground_truth = "aligned";
  CHECK(compare_ground_truths(reports) == GroundTruths::different);
}

TEST_CASE("a page has no external references, even with hostile names") {
  const test::TemporaryFolder folder;
  const std::string hostile = "<img src=x onerror=alert(1)>\"'&{{data}}.png";
  for (int i = 0; i < 6; ++i)
    test::write_image(folder / (std::to_string(i) + hostile), uint64_t(i));
  Judgment judgment = example("cwcwcw");
  judgment.layout.scope.sequences[0] = {{"</script><script>alert(2)</script>", 6}, true};
  judgment.layout.columns = {{0, 0, 6}};
  judgment.recognized.push_back({0, {0, 5}});  // not the best match: the page has a matrix
  const GroundTruth truth = example_truth(judgment);
  const Evaluation evaluation = evaluation_of(judgment, truth, "<b>method</b>", "<i>query</i>");
  const SequenceSource sequence = open_sequence({folder.path(), {}});
  const std::string page = evaluation_page(evaluation, report_of(evaluation, {}), {}, "<s>all</s>",
                                           {sequence, {sequence}}, {});
  CHECK_FALSE(test::has(page, "<s>all"));
  CHECK_FALSE(test::has(page, "<img src=x"));
  CHECK_FALSE(test::has(page, "</script><script>alert"));
  CHECK_FALSE(test::has(page, "<b>method"));
  CHECK(test::has(page, "&lt;b&gt;method"));
  CHECK(test::has(page, "&lt;img src=x onerror=alert(1)&gt;&quot;&#39;&amp;{{data}}.png"));
  CHECK_FALSE(test::has(page, "://"));
  CHECK(test::has(page, "default-src 'none'"));
  CHECK(test::has(page, "data:image/jpeg;base64,/9j/"));
  CHECK(test::has(page, "data:image/png;base64,"));
}

TEST_CASE("an empty page is a valid page") {
  const Judgment judgment = example("");
  GroundTruth truth;
  const Evaluation evaluation = evaluation_of(judgment, truth);
  CHECK(test::has(evaluation_page(evaluation, report_of(evaluation, {}), {}, "", {}, {}),
                  "No query has"));
}

namespace {

size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string page_of(const Judgment& judgment, const GroundTruth& truth,
                    const Monitor& monitor = {}) {
  const Evaluation evaluation = evaluation_of(judgment, truth);
  return evaluation_page(evaluation, report_of(evaluation, {}), {}, "Recognized in 2 of 8 frames.",
                         {}, monitor);
}

}  // namespace

TEST_CASE("a page has a matrix only if it shows more than the best matches") {
  Judgment judgment = example("cccc");
  judgment.recognized = {{0, *judgment.outcomes.queries[0].best}};
  const GroundTruth truth = example_truth(judgment);
  std::string page = page_of(judgment, truth);
  CHECK_FALSE(test::has(page, "#matrix\""));
  CHECK_FALSE(test::has(page, "<svg class=\"matrix"));
  CHECK(test::has(page, "<summary>Set anchors</summary>"));
  judgment.recognized.push_back({0, {0, 3}});
  page = page_of(judgment, truth);
  CHECK(test::has(page, "<a href=\"#matrix\">"));
  CHECK(test::has(page, "<svg class=\"matrix wide\""));
}

TEST_CASE("a page has images of evenly spaced queries and of their best matches") {
  const test::TemporaryFolder folder;
  for (int i = 0; i < 7; ++i) test::write_image(folder / (std::to_string(i) + ".png"), uint64_t(i));
  Judgment judgment = example("ccccccc");
  judgment.outcomes.queries[3].best.reset();
  const SequenceSource sequence = open_sequence({folder.path(), {}});
  const Gallery gallery = make_gallery(judgment, example_truth(judgment), {"distance"},
                                       {sequence, {sequence}}, {}, {.pictured = 3});
  const Json images = images_json(gallery.pictured);  // frames 0, 3 and 6; frame 3 has no match
  REQUIRE(images.size() == 5);
  CHECK(images["query 3"][1] == "3.png");
  CHECK(images["0 6"][1] == "6.png");
  CHECK(images["0 6"][0].get<std::string>().starts_with("data:image/jpeg;base64,/9j/"));
  CHECK(images_json({}).dump() == "{}");
}

TEST_CASE("a page begins with its summary and states the protocol once") {
  Judgment judgment = example("cwcwcwcw");
  judgment.recognized.push_back({0, {0, 5}});  // not the best match: the page has a matrix
  GroundTruth truth = example_truth(judgment);
  truth.protocol = "pairs from my desk";
  const std::string page = page_of(judgment, truth);
  size_t at = 0;  // charts and images come before numbers
  for (const char* part : {"<p class=\"summary\">Recognized in 2 of 8 frames.</p>",
                           "<svg class=\"timeline wide\"", "<article class=\"card mistake\"",
                           "<svg class=\"matrix wide\"", "<svg class=\"precision-recall any\"",
                           "<dl class=\"facts\">", "<details><summary>What these numbers count"}) {
    INFO(part);
    CHECK(page.find(part) > at);
    at = page.find(part);
  }
  CHECK(count_of(page, "pairs from my desk") == 1);
  CHECK(test::has(page, "<dt>scores</dt><dd>distance</dd>"));
  CHECK(test::has(page, "best match incorrect, not recognized"));
  CHECK(test::has(page, "worst mistakes"));
  CHECK_FALSE(test::has(page, "{{"));
}

TEST_CASE("a timeline counts frames, and its bands have the sequences' names") {
  Judgment judgment = example("cccccccc", 20);
  ScoreLayout& layout = judgment.layout;
  layout.scope.sequences = {
      {{"monday", 111}, true}, {{"unused", 50}, false}, {{"<tuesday>", 41}, true}};
  layout.columns = {{0, 0, 92}, {2, 92, 22}};
  judgment.recognized.push_back({19, {0, 30}});  // not the best match: the page has a matrix
  const std::string page = page_of(judgment, example_truth(example("cccccccc", 20)));
  const std::string timeline =
      page.substr(page.find("<svg class=\"timeline wide\""),
                  page.find("</svg>", page.find("<svg class=\"timeline wide\"")) -
                      page.find("<svg class=\"timeline wide\""));
  CHECK(test::has(timeline, ">100</text>"));
  CHECK(test::has(timeline, ">monday</text>"));
  CHECK(test::has(timeline, ">&lt;tuesday&gt;</text>"));
  CHECK_FALSE(test::has(timeline, "unused"));
  const std::string matrix = page.substr(page.find("<svg class=\"matrix wide\""));
  CHECK(test::has(matrix, ">19</text>"));  // the first window's anchor
  CHECK(test::has(matrix, ">monday</text>"));
}

TEST_CASE("the cost of a page depends on its content, not on the claimed number of frames") {
  Judgment judgment = example("cwcwcwcw", 3);
  constexpr size_t kClaimed = std::numeric_limits<int32_t>::max();
  judgment.layout.scope.sequences[0].sequence.frames = kClaimed;
  judgment.layout.columns = {{0, 0, kClaimed - 2}};
  judgment.recognized.push_back({2, {0, 9}});  // not the best match: the page has a matrix
  const std::string page = page_of(judgment, example_truth(judgment));
  CHECK(count_of(page, "2000000000</text>") >= 2);  // on the axes of timeline and matrix
  CHECK(page.size() < 1000000);
}

TEST_CASE("a page can be stopped during drawing") {
  const Judgment judgment = example("cwcwcwcw");
  const GroundTruth truth = example_truth(judgment);
  const std::atomic<bool> stop{true};
  Monitor monitor;
  monitor.stop = &stop;
  CHECK(test::error_kind([&] { page_of(judgment, truth, monitor); }) == ErrorKind::interrupted);
  CHECK(test::error_kind([&] {
          matrix_chart(judgment, truth, PixelGrid(judgment.layout, 100), {}, "", {}, monitor);
        }) == ErrorKind::interrupted);
}

TEST_CASE("without ground truth, a page shows matches without evaluation") {
  Judgment judgment = example("cccccccc");
  const GroundTruth truth = unknown_ground_truth(judgment.layout.scope);
  judgment.by = JudgedBy::nothing;
  for (QueryOutcome& query : judgment.outcomes.queries) query.verdict = Verdict::ignored;
  judgment.verdicts.assign(8, Verdict::ignored);
  judgment.verdicts[3] = Verdict::none;
  const Evaluation evaluation = evaluation_of(judgment, truth);
  Report report = report_of(evaluation, {});
  report.counts.recognitions.ignored = 7;
  const std::string page = evaluation_page(evaluation, report, {}, "", {}, {});
  CHECK(test::has(page, "recognized, not judged"));
  CHECK_FALSE(test::has(page, "recognized, incorrect"));
  CHECK_FALSE(test::has(page, "worst mistakes"));
  CHECK_FALSE(test::has(page, "class=\"card mistake\""));
  CHECK(test::has(page, "class=\"card recognition unjudged two\""));
  CHECK_FALSE(test::has(page, "correct: query"));
  CHECK_FALSE(test::has(page, "; the ground truth has no match"));
  CHECK(test::has(page, "<dd>7</dd>"));
}

TEST_CASE("a page has risk against coverage") {
  Judgment judgment = example("cwcwcw");
  const std::string page = page_of(judgment, example_truth(judgment));
  CHECK(test::has(page, "<svg class=\"risk-coverage any\""));
  CHECK(test::has(page, "risk: share of mistakes among them"));
}

TEST_CASE("a page of thinned sequences has the recordings' frames for saved labels") {
  Judgment judgment = example("cwcwcw");
  const GroundTruth truth = example_truth(judgment);
  CHECK_FALSE(test::has(page_of(judgment, truth), "\"query_sources\""));
  Selection kept;
  kept.recorded_frames = 20;
  kept.selected_fps = 5;
  kept.sources = {0, 3, 7, 9, 12, 19};
  judgment.layout.scope.query.selection = kept;
  judgment.layout.scope.sequences[0].sequence.selection = kept;
  const std::string page = page_of(judgment, truth);
  CHECK(test::has(page, "\"query_sources\":[0,3,7,9,12,19]"));
  CHECK(test::has(page, "\"train_sources\":[[0,3,7,9,12,19]]"));
}
