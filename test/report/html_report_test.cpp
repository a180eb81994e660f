#include "report/html_report.h"

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/json.h"
#include "report/gallery.h"
#include "report/html_text.h"
#include "report/scores_report.h"
#include "report/thumbnails.h"
#include "support.h"

using namespace vpr;

namespace {

/// Twenty queries, best matches as the letters say (c right, w wrong), scores as they come.
Judgement example(const std::string& letters, size_t window_length = 1) {
  Judgement judgement;
  ScoreLayout& layout = judgement.layout;
  layout.window_length = window_length;
  layout.scope = {letters.size() + window_length - 1, {{"ref", 40, true}}};
  layout.columns = {{0, 0, 40 - window_length + 1}};
  judgement.outcomes.query_frames = layout.scope.query_frames;
  judgement.outcomes.window_length = window_length;
  for (size_t q = 0; q < letters.size(); ++q) {
    const size_t frame = layout.anchor(q);
    judgement.outcomes.queries.push_back({frame,
                                          letters[q] == 'c' ? Verdict::correct : Verdict::incorrect,
                                          true,
                                          FrameMatch{0, frame},
                                          score_key(double(q), ScoreKind::distance),
                                          false,
                                          {}});
  }
  judgement.fixes.assign(layout.scope.query_frames, Fix::none);
  judgement.single_best = single_best_curve(judgement.outcomes);
  return judgement;
}

GroundTruth example_truth(const Judgement& judgement) {
  return read_ground_truth({"aligned", {}, 0}, judgement.layout.scope);
}

std::vector<size_t> chosen(const std::vector<GalleryItem>& items, GalleryKind kind) {
  std::vector<size_t> queries;
  for (const GalleryItem& item : items)
    if (item.kind == kind) queries.push_back(item.query);
  return queries;
}

}  // namespace

TEST_CASE("text in a page can neither open an element nor leave an attribute") {
  CHECK(html_escaped("<a href=\"x\" id='y'>&") ==
        "&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;");
  CHECK(html_escaped("a\x01z\xff") == "a\xef\xbf\xbdz\xef\xbf\xbd");
  CHECK(html_escaped("\xc3\xa4") == "\xc3\xa4");
}

TEST_CASE("data in a page cannot end its script") {
  CHECK(script_json(Json{{"a", "</script><!--"}}) == "{\"a\":\"\\u003c/script>\\u003c!--\"}");
}

TEST_CASE("base64 is that of RFC 4648's examples") {
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

TEST_CASE("what is put into a page is not looked through again") {
  CHECK(fill_page("a{{x}}b{{y}}c", {{"x", "{{y}}"}, {"y", "2"}}) == "a{{y}}b2c");
  CHECK(fill_page("a {{ b", {}) == "a {{ b");
}

TEST_CASE("the gallery has the worst mistakes and the best and weakest hits, well apart") {
  const Judgement judgement = example("cwwwwwwccccccccccccccccccccw");
  const auto items = choose_gallery(judgement, example_truth(judgement), 3);
  CHECK(chosen(items, GalleryKind::mistake) == std::vector<size_t>{1, 6, 27});
  CHECK(chosen(items, GalleryKind::hit) == std::vector<size_t>{0, 7, 12});
  CHECK(chosen(items, GalleryKind::weak) == std::vector<size_t>{26, 21, 16});
  CHECK(items[0].truth == FrameMatch{0, 1});
  CHECK(choose_gallery(example(""), {}, 3).empty());
}

TEST_CASE("queries without a match have no true place in the gallery") {
  const Judgement judgement = example("w");
  GroundTruth truth;
  truth.pairs.resize(1);
  CHECK_FALSE(choose_gallery(judgement, truth, 3)[0].truth);
}

TEST_CASE("a strip ends at the anchor and spans the window") {
  CHECK(strip_frames(7, 1, 5) == std::vector<size_t>{7});
  CHECK(strip_frames(7, 3, 5) == std::vector<size_t>{5, 6, 7});
  CHECK(strip_frames(39, 40, 5) == std::vector<size_t>{0, 10, 20, 30, 39});
  CHECK(strip_frames(2, 40, 5) == std::vector<size_t>{0, 1, 2});
}

TEST_CASE("thumbnails are small, and frames that cannot be read are gaps") {
  const test::TemporaryFolder folder;
  test::write_image(folder / "1.png", 1, 400, 300);
  test::write_text(folder / "2.png", "no image");
  const Sequence sequence = open_sequence({folder.path(), {}});
  const auto found = make_thumbnails(sequence, {0, 1, 9}, 100, {});
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

TEST_CASE("a page names nothing outside itself, however hostile its names are") {
  const test::TemporaryFolder folder;
  const std::string hostile = "<img src=x onerror=alert(1)>\"'&{{data}}.png";
  for (int i = 0; i < 6; ++i)
    test::write_image(folder / (std::to_string(i) + hostile), uint64_t(i));
  Judgement judgement = example("cwcwcw");
  judgement.layout.scope.sequences[0] = {"</script><script>alert(2)</script>", 6, true};
  judgement.layout.columns = {{0, 0, 6}};
  const GroundTruth truth = example_truth(judgement);
  const Json report = scores_report_json({"<b>method</b>", {}, 1, {}}, "<i>query</i>", judgement,
                                         truth, "xxh3:0", {});
  const Sequence sequence = open_sequence({folder.path(), {}});
  const std::string page =
      html_report(report, judgement, truth, nullptr, {sequence, {sequence}}, {});
  CHECK(page.find("<img src=x") == std::string::npos);
  CHECK(page.find("</script><script>alert") == std::string::npos);
  CHECK(page.find("<b>method") == std::string::npos);
  CHECK(page.find("&lt;b&gt;method") != std::string::npos);
  CHECK(page.find("&lt;img src=x onerror=alert(1)&gt;&quot;&#39;&amp;{{data}}.png") !=
        std::string::npos);
  CHECK(page.find("://") == std::string::npos);
  CHECK(page.find("default-src 'none'") != std::string::npos);
  CHECK(page.find("data:image/jpeg;base64,/9j/") != std::string::npos);
  CHECK(page.find("data:image/png;base64,") != std::string::npos);
}

TEST_CASE("a page of nothing is a page") {
  const Judgement judgement = example("");
  GroundTruth truth;
  const Json report = scores_report_json({}, "none", judgement, truth, "xxh3:0", {});
  CHECK(html_report(report, judgement, truth, nullptr, {}, {}).find("No query has") !=
        std::string::npos);
}
