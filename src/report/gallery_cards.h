// The gallery of a report's page.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "evaluation/judgement.h"
#include "report/gallery.h"
#include "report/html_report.h"
#include "report/thumbnails.h"

namespace vpr {

/// The cards of the gallery, with the pictures that they need. What is given must stay alive.
class GalleryCards {
 public:
  GalleryCards(const Judgement& judgement, const GroundTruth& truth, const FrameSources& sources);

  /// Throws as make_thumbnails does.
  void read_frames(const Monitor& monitor);

  std::string html() const;
  std::string note() const;

 private:
  const QueryOutcome& outcome_of(const GalleryItem& item) const;
  std::vector<size_t> frames_at(size_t anchor) const;
  std::string place(const FrameMatch& match) const;
  std::string reference_strip(const std::string& title, const FrameMatch& match) const;
  std::string card(const GalleryItem& item) const;

  const Judgement& judgement_;
  const FrameSources& sources_;
  bool is_judged_;
  std::vector<GalleryItem> items_;
  std::map<size_t, Thumbnail> query_;
  std::vector<std::map<size_t, Thumbnail>> references_;
};

}  // namespace vpr
