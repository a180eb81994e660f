#include "report/gallery_cards.h"

#include <fmt/format.h>

#include "report/html_text.h"

namespace vpr {
namespace {

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

GalleryCards::GalleryCards(const Judgement& judgement, const GroundTruth& truth,
                           const FrameSources& sources)
    : judgement_(judgement),
      sources_(sources),
      is_judged_(truth.is_known),
      items_(choose_gallery(judgement, truth, kMostItems)) {}

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
    query_ = make_replay_thumbnails(*sources_.query, judgement_.layout.scope.replay, query,
                                    kThumbnailSide, monitor);
  references_.resize(references.size());
  for (size_t s = 0; s < references.size(); ++s)
    if (sources_.references[s])
      references_[s] =
          make_replay_thumbnails(*sources_.references[s], judgement_.layout.scope.sequences[s].kept,
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
  return judgement_.outcomes.queries[item.query];
}

std::vector<size_t> GalleryCards::frames_at(size_t anchor) const {
  return strip_frames(anchor, judgement_.layout.window_length, kStripFrames);
}

std::string GalleryCards::place(const FrameMatch& match) const {
  return fmt::format("{} {}", judgement_.layout.scope.sequences[match.sequence].name,
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
  html += fmt::format("<p>{} {:.6g}{}{}</p>", enum_name(judgement_.outcomes.kind),
                      score_of_key(outcome.key, judgement_.outcomes.kind),
                      is_recognised(judgement_, outcome) ? ", recognised" : ", not recognised",
                      item.truth || !is_judged_ ? "" : "; the ground truth has no match");
  html += strip(fmt::format("query {}", outcome.frame), frames_at(outcome.frame), query_);
  html += reference_strip("best match", *outcome.best);
  if (item.truth) html += reference_strip("true place", *item.truth);
  return html + "</article>\n";
}

}  // namespace vpr
