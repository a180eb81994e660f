#include "fabmap/explanation_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "chart/chart.h"
#include "present/table.h"
#include "sequence/frames.h"

namespace vpr {
namespace {

void add_rows(Table& table, const char* side, const std::vector<WordEvidence>& words) {
  for (const WordEvidence& word : words)
    add_row(table, side, word.word, word.in_frame ? "yes" : "no", word.in_view ? "yes" : "no",
            fmt::format("{:+.3f}", word.log_odds));
}

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kTitleHeight = 28;
const cv::Scalar kText(40, 40, 40);
const cv::Scalar kPaper(245, 245, 245);

cv::Scalar color_of_point(bool speaks_for) {
  return bgr_of(speaks_for ? Meaning::correct : Meaning::incorrect);
}

/// The position of an image on the canvas.
struct Placement {
  double scale = 1;
  cv::Point2d origin;

  cv::Point operator()(cv::Point2f at) const {
    return {cvRound(origin.x + scale * static_cast<double>(at.x)),
            cvRound(origin.y + scale * static_cast<double>(at.y))};
  }
};

Placement place_image(cv::Mat& canvas, const MarkedImage& image, int left, int top) {
  const int width = cv::getTextSize(image.title, cv::FONT_HERSHEY_SIMPLEX, 0.5, 1, nullptr).width;
  cv::putText(canvas, image.title, {left + 6, top + 20}, cv::FONT_HERSHEY_SIMPLEX,
              std::min(0.5, 0.5 * (kWidth - 12) / width), kText, 1, cv::LINE_AA);
  Placement placement;
  placement.origin = {static_cast<double>(left), static_cast<double>(top + kTitleHeight)};
  if (image.gray.empty()) return placement;
  placement.scale = std::min(static_cast<double>(kWidth) / image.gray.cols,
                             static_cast<double>(kHeight) / image.gray.rows);
  cv::Mat scaled;
  cv::resize(image.gray, scaled, {}, placement.scale, placement.scale, cv::INTER_LINEAR);
  cv::cvtColor(scaled, scaled, cv::COLOR_GRAY2BGR);
  scaled = scaled(cv::Rect(0, 0, std::min(scaled.cols, kWidth), std::min(scaled.rows, kHeight)));
  scaled.copyTo(canvas(cv::Rect(left, top + kTitleHeight, scaled.cols, scaled.rows)));
  return placement;
}

// Circles at all words, and the numbers that cover neither a circle nor another number.
void mark(cv::Mat& canvas, const MarkedImage& image, const Placement& placement) {
  std::vector<cv::Rect> taken;
  for (const MarkedPoint& point : image.points) {
    const cv::Point at = placement(point.at);
    cv::circle(canvas, at, 7, color_of_point(point.speaks_for), 2, cv::LINE_AA);
    taken.emplace_back(at.x - 8, at.y - 8, 16, 16);
  }
  for (const MarkedPoint& point : image.points) {
    const std::string number = std::to_string(point.word);
    const cv::Size size = cv::getTextSize(number, cv::FONT_HERSHEY_SIMPLEX, 0.4, 1, nullptr);
    const cv::Point at = placement(point.at);
    for (const cv::Point& corner : {at + cv::Point(10, -size.height / 2),
                                    at + cv::Point(-10 - size.width, -size.height / 2)}) {
      const cv::Rect box(corner, size);
      const auto covers = [&](const cv::Rect& other) { return (other & box).area() > 0; };
      if (std::ranges::any_of(taken, covers)) continue;
      taken.push_back(box);
      const cv::Point baseline = corner + cv::Point(0, size.height);
      cv::putText(canvas, number, baseline, cv::FONT_HERSHEY_SIMPLEX, 0.4, kPaper, 3, cv::LINE_AA);
      cv::putText(canvas, number, baseline, cv::FONT_HERSHEY_SIMPLEX, 0.4,
                  color_of_point(point.speaks_for), 1, cv::LINE_AA);
      break;
    }
  }
}

// One line per word, between its first points in both images.
void join(cv::Mat& canvas, const ImagePair& pair, const Placement& query, const Placement& view) {
  std::vector<uint32_t> joined;
  for (const MarkedPoint& from : pair.query.points) {
    if (!from.speaks_for || std::find(joined.begin(), joined.end(), from.word) != joined.end())
      continue;
    const auto to = std::ranges::find(pair.view.points, from.word, &MarkedPoint::word);
    if (to == pair.view.points.end()) continue;
    joined.push_back(from.word);
    cv::line(canvas, query(from.at), view(to->at), color_of_point(true), 1, cv::LINE_AA);
  }
}

}  // namespace

std::string explanation_text(const Explanation& explanation) {
  std::string text = fmt::format("Frame {}: new place with probability {:.4f}\n", explanation.frame,
                                 explanation.new_place);
  if (explanation.places.empty()) text += "There is no place to explain.\n";
  for (const PlaceExplanation& place : explanation.places) {
    Table table;
    table.title = fmt::format("{} (view {}), probability {:.4f}, log-odds {:+.2f}", place.place,
                              place.view, place.match.score, place.log_odds);
    table.columns = {"speaks", "word", "in the frame", "in the view", "log-odds"};
    add_rows(table, "for", place.for_it);
    add_rows(table, "against", place.against);
    double rest = place.log_odds;
    for (const auto& words : {place.for_it, place.against})
      for (const WordEvidence& word : words) rest -= word.log_odds;
    add_row(table, "all other words", "", "", "", fmt::format("{:+.3f}", rest));
    text += "\n" + render_table(table, TableFormat::text);
  }
  return text;
}

MarkedImage locate_words(const SequenceSource& sequence, size_t frame,
                         const FabmapDatabase& database, const Monitor& monitor) {
  MarkedImage image;
  if (!sequence.files.empty()) {
    if (frame < sequence.files.size())
      image.gray = decode_image(sequence.files[frame], PixelFormat::gray);
  } else {
    for_each_frame(sequence, PixelFormat::gray, Unreadable::skip, monitor,
                   [&](size_t index, const cv::Mat& decoded) {
                     if (index == frame) image.gray = decoded.clone();
                   });
  }
  if (image.gray.empty())
    throw Error(ErrorKind::input, "{}: has no readable frame {}", sequence.argument.path.string(),
                frame);
  const LocalFeatures found = find_features(image.gray, database.settings.features);
  const std::vector<uint32_t> words =
      nearest_words(make_vocabulary(database.vocabulary), found.descriptors);
  for (size_t i = 0; i < words.size(); ++i) image.points.push_back({found.points[i], words[i]});
  return image;
}

MarkedImage mark_words(const MarkedImage& located, const PlaceExplanation& place,
                       const std::string& title) {
  MarkedImage image{located.gray, {}, title};
  const auto add = [&](const std::vector<WordEvidence>& words, bool speaks_for) {
    for (const WordEvidence& word : words)
      for (const MarkedPoint& point : located.points)
        if (point.word == word.word) image.points.push_back({point.at, point.word, speaks_for});
  };
  add(place.against, false);
  add(place.for_it, true);
  return image;
}

cv::Mat draw_word_pairs(const std::vector<ImagePair>& pairs) {
  const int row_height = kTitleHeight + kHeight;
  cv::Mat canvas(std::max<int>(1, static_cast<int>(pairs.size())) * row_height, 2 * kWidth, CV_8UC3,
                 kPaper);
  int top = 0;
  for (const ImagePair& pair : pairs) {
    const Placement query = place_image(canvas, pair.query, 0, top);
    const Placement view = place_image(canvas, pair.view, kWidth, top);
    join(canvas, pair, query, view);
    mark(canvas, pair.query, query);
    mark(canvas, pair.view, view);
    top += row_height;
  }
  return canvas;
}

}  // namespace vpr
