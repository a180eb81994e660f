#include "present/gallery.h"

#include <algorithm>
#include <cstring>
#include <mutex>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "present/html_page.h"
#include "sequence/frames.h"

namespace vpr {
namespace {

constexpr size_t kLeastApart = 5;

// The middle one of the references from frame `earliest` on that show the query's place.
std::optional<FrameMatch> middle_match(const GroundTruth& truth, const ScoreLayout& layout,
                                       size_t frame, size_t earliest) {
  struct Run {
    uint32_t sequence;
    size_t first;
    size_t count;
  };
  std::vector<Run> runs;
  size_t all = 0;
  for (const GroundTruth::Pair& pair : truth.pairs[frame]) {
    const size_t end = std::min<size_t>(size_t{pair.last()} + 1,
                                        layout.scope.sequences[pair.sequence].sequence.frames);
    const size_t first = std::max<size_t>(pair.first, earliest);
    if (pair.label != PlaceLabel::same || first >= end) continue;
    runs.push_back({pair.sequence, first, end - first});
    all += end - first;
  }
  size_t before = all / 2;
  for (const Run& run : runs) {
    if (before < run.count) return FrameMatch{run.sequence, run.first + before};
    before -= run.count;
  }
  return std::nullopt;
}

// With a whole window if there is one.
std::optional<FrameMatch> true_match(const GroundTruth& truth, const ScoreLayout& layout,
                                     size_t frame) {
  const auto whole = middle_match(truth, layout, frame, layout.window_length - 1);
  return whole ? whole : middle_match(truth, layout, frame, 0);
}

constexpr int kQuality = 70;

std::vector<std::byte> small_jpeg(const cv::Mat& image, int side) {
  const double scale = std::min(1.0, double(side) / std::max({image.cols, image.rows, 1}));
  const cv::Size size(std::max(1, cvRound(image.cols * scale)),
                      std::max(1, cvRound(image.rows * scale)));
  cv::Mat resized;
  cv::resize(image, resized, size, 0, 0, cv::INTER_AREA);
  std::vector<uint8_t> jpeg;
  cv::imencode(".jpg", resized, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  std::vector<std::byte> bytes(jpeg.size());
  std::memcpy(bytes.data(), jpeg.data(), jpeg.size());
  return bytes;
}

constexpr size_t kMostItems = 18;  // of each kind
constexpr size_t kStripFrames = 5;
constexpr int kThumbnailSide = 128;  // pixels

std::string strip(const std::string& title, const std::vector<size_t>& frames,
                  const std::map<size_t, Thumbnail>& thumbnails) {
  const auto last = thumbnails.find(frames.back());
  const std::string name = last == thumbnails.end() ? "" : ": " + last->second.name;
  std::string html = "<figure><figcaption>" + html_escaped(title + name) + "</figcaption>";
  if (thumbnails.empty()) return html + "</figure>";
  html += "<div class=\"strip\">";
  for (const size_t frame : frames) {
    const auto found = thumbnails.find(frame);
    if (found == thumbnails.end() || found->second.jpeg.empty())
      html += "<span class=\"gone\">no picture</span>";
    else
      html += fmt::format("<img alt=\"frame {}\" title=\"{}\" src=\"data:image/jpeg;base64,{}\">",
                          frame, html_escaped(found->second.name), base64(found->second.jpeg));
  }
  return html + "</div></figure>";
}

}  // namespace

std::vector<GalleryItem> choose_gallery(const Judgment& judgment, const GroundTruth& truth,
                                        size_t most) {
  const auto& queries = judgment.outcomes.queries;
  const size_t apart = std::max(kLeastApart, judgment.layout.window_length);
  std::vector<GalleryItem> items;
  const auto choose = [&](GalleryKind kind, Verdict verdict, bool is_best_first) {
    std::vector<size_t> order;
    for (size_t q = 0; q < queries.size(); ++q)
      if (queries[q].verdict == verdict && queries[q].best) order.push_back(q);
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      const uint64_t first = confidence_key(queries[a], judgment.outcomes.confidence);
      const uint64_t second = confidence_key(queries[b], judgment.outcomes.confidence);
      return is_best_first ? first < second : first > second;
    });
    const size_t begin = items.size();
    for (const size_t q : order) {
      if (items.size() - begin == most) break;
      const bool is_near = std::any_of(items.begin(), items.end(), [&](const GalleryItem& item) {
        const bool same_query = item.query == q;
        const size_t away = item.query > q ? item.query - q : q - item.query;
        return same_query || (item.kind == kind && away < apart);
      });
      if (!is_near)
        items.push_back({kind, q, true_match(truth, judgment.layout, queries[q].frame)});
    }
  };
  const Verdict good = truth.is_known ? Verdict::correct : Verdict::ignored;
  choose(GalleryKind::mistake, Verdict::incorrect, true);
  choose(GalleryKind::recognition, good, true);
  choose(GalleryKind::weak, good, false);
  return items;
}

std::vector<size_t> strip_frames(size_t anchor, size_t window_length, size_t most) {
  const size_t length = std::min(window_length, anchor + 1);
  const size_t count = std::min(length, most);
  std::vector<size_t> frames;
  for (size_t i = 0; i < count; ++i) {
    const size_t back = count == 1 ? 0 : (count - 1 - i) * (length - 1) / (count - 1);
    frames.push_back(anchor - back);
  }
  return frames;
}

std::map<size_t, Thumbnail> make_thumbnails(const SequenceSource& sequence,
                                            const std::set<size_t>& wanted, int side,
                                            const Monitor& monitor) {
  std::map<size_t, Thumbnail> found;
  std::mutex mutex;
  const auto keep = [&](size_t index, std::string name, const cv::Mat& image) {
    std::vector<std::byte> jpeg =
        image.empty() ? std::vector<std::byte>{} : small_jpeg(image, side);
    const std::scoped_lock lock(mutex);
    found[index] = {std::move(name), std::move(jpeg)};
  };
  if (wanted.empty()) return found;
  if (sequence.kind != SequenceKind::images) {
    for_each_frame(sequence, PixelFormat::bgr, Unreadable::skip, monitor,
                   [&](size_t index, const cv::Mat& image) {
                     if (wanted.contains(index)) keep(index, fmt::format("#{}", index), image);
                   });
    return found;
  }
  const std::vector<size_t> order(wanted.begin(), wanted.end());
  parallel_for(order.size(), monitor, [&](size_t i) {
    if (order[i] >= sequence.files.size()) return;
    const auto& file = sequence.files[order[i]];
    cv::Mat image;
    try {
      image = decode_image(file, PixelFormat::bgr);
    } catch (const Error&) {  // shown as a gap
    }
    keep(order[i], file.filename().string(), image);
  });
  return found;
}

std::map<size_t, Thumbnail> make_thumbnails(const SequenceSource& recording,
                                            const Selection& selection,
                                            const std::set<size_t>& wanted, int side,
                                            const Monitor& monitor) {
  if (selection.is_all()) return make_thumbnails(recording, wanted, side, monitor);
  std::set<size_t> sources;
  for (const size_t frame : wanted) sources.insert(selection.sources[frame]);
  const std::map<size_t, Thumbnail> recorded = make_thumbnails(recording, sources, side, monitor);
  std::map<size_t, Thumbnail> found;
  for (const size_t frame : wanted)
    if (const auto source = recorded.find(selection.sources[frame]); source != recorded.end())
      found.insert({frame, source->second});
  return found;
}

GalleryCards::GalleryCards(const Judgment& judgment, const GroundTruth& truth,
                           const FrameSources& sources)
    : judgment_(judgment),
      sources_(sources),
      is_judged_(truth.is_known),
      items_(choose_gallery(judgment, truth, kMostItems)) {}

void GalleryCards::read_frames(const Monitor& monitor) {
  std::set<size_t> query;
  std::vector<std::set<size_t>> references(sources_.references.size());
  const auto want = [&](const FrameMatch& match) {
    if (match.sequence < references.size())
      for (const size_t frame : frames_at(match.reference))
        references[match.sequence].insert(frame);
  };
  for (const GalleryItem& item : items_) {
    const QueryOutcome& outcome = outcome_of(item);
    for (const size_t frame : frames_at(outcome.frame)) query.insert(frame);
    want(*outcome.best);
    if (item.truth) want(*item.truth);
  }
  if (sources_.query)
    query_ = make_thumbnails(*sources_.query, judgment_.layout.scope.query.selection, query,
                             kThumbnailSide, monitor);
  references_.resize(references.size());
  for (size_t s = 0; s < references.size(); ++s)
    if (sources_.references[s])
      references_[s] = make_thumbnails(*sources_.references[s],
                                       judgment_.layout.scope.sequences[s].sequence.selection,
                                       references[s], kThumbnailSide, monitor);
}

std::string GalleryCards::html() const {
  std::string html;
  for (const GalleryItem& item : items_) html += card(item);
  return html;
}

std::string GalleryCards::note() const {
  if (items_.empty())
    return is_judged_ ? "No query has a best match that can be judged."
                      : "No query has a best match.";
  std::string text = fmt::format(
      "At most {} of each kind, of queries at least a window apart. Arrow keys go from one to the "
      "next, / to the search.",
      kMostItems);
  if (!sources_.query) text += " Give the sequences (--query, --train or --dataset) for pictures.";
  return text;
}

const QueryOutcome& GalleryCards::outcome_of(const GalleryItem& item) const {
  return judgment_.outcomes.queries[item.query];
}

std::vector<size_t> GalleryCards::frames_at(size_t anchor) const {
  return strip_frames(anchor, judgment_.layout.window_length, kStripFrames);
}

std::string GalleryCards::place(const FrameMatch& match) const {
  return fmt::format("{} {}", judgment_.layout.scope.sequences[match.sequence].sequence.name,
                     match.reference);
}

std::string GalleryCards::reference_strip(const std::string& title, const FrameMatch& match) const {
  static const std::map<size_t, Thumbnail> kNone;
  const auto& thumbnails =
      match.sequence < references_.size() ? references_[match.sequence] : kNone;
  return strip(title + " " + place(match), frames_at(match.reference), thumbnails);
}

std::string GalleryCards::card(const GalleryItem& item) const {
  const QueryOutcome& outcome = outcome_of(item);
  const std::string_view kind = enum_name(item.kind);
  const char* verdict = !is_judged_                           ? ""
                        : outcome.verdict == Verdict::correct ? "right: "
                                                              : "wrong: ";
  std::string html = fmt::format(
      "<article class=\"card {0}{1}\" data-kind=\"{0}\" data-at=\"{4}\" "
      "tabindex=\"0\"><h3>{2}query {3}</h3>",
      kind, is_judged_ ? "" : " unjudged", verdict, outcome.frame, item.query);
  html += fmt::format("<p>{} {:.6g}{}{}</p>", enum_name(judgment_.outcomes.kind),
                      score_of_key(outcome.key, judgment_.outcomes.kind),
                      is_recognized(judgment_, outcome) ? ", recognized" : ", not recognized",
                      item.truth || !is_judged_ ? "" : "; the ground truth has no match");
  html += strip(fmt::format("query {}", outcome.frame), frames_at(outcome.frame), query_);
  html += reference_strip("best match", *outcome.best);
  if (item.truth) html += reference_strip("true place", *item.truth);
  return html + "</article>\n";
}

}  // namespace vpr
