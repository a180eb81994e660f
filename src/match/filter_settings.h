// Settings of the filter over places and rates (filter.h).
#pragma once

#include <cstdint>

namespace vpr {

struct FilterSettings {
  /// A frame that differs from the last one kept by at least this share of the typical distance is
  /// a view, in the query and in training sequences; the filter steps from view to view.
  double view_change = 0.15;
  double sharpness = 0.5;     ///< log-likelihood that a deviation is worth
  double unmatched = -0.5;    ///< the z that is as likely nowhere as at its training frame
  double jump = 0.001;        ///< chance to be carried anywhere, per view
  double enter = 0.01;        ///< chance to leave the map, per view
  double leave = 0.05;        ///< chance to come back onto it, anywhere, per view
  double rate_change = 0.05;  ///< chance to change the rate, per view
  uint64_t near_views = 10;   ///< training views so close to the best one are not elsewhere
  /// A path is trusted once it was the best one for so many views (the mean of those of the query
  /// and those of the training sequence that it passed) and has had establish_margin and support;
  /// or once its evidence was so large (PathTrack) and it has had establish_margin; and then, for
  /// as long as it goes on, wherever it has establish_margin. One of twice as many views is trusted
  /// once it has had kLongShare of both, and then at any margin.
  uint64_t establish_views = 18;
  double establish_margin = 8;     ///< in deviations
  double establish_evidence = 16;  ///< in deviations
  double support = 1.5;            ///< least mean of -z at the best places of 24 views
  /// Least sum of the shares that its last views, weighted 1/2, 1/4, ..., have of a path's support
  /// and the last one of its margin, less how much more the query changed than the training walk.
  double present_support = 1.1;
};

template <class Visitor>
void visit_fields(FilterSettings& settings, Visitor&& visit) {
  visit("view_change", settings.view_change);
  visit("sharpness", settings.sharpness);
  visit("unmatched", settings.unmatched);
  visit("jump", settings.jump);
  visit("enter", settings.enter);
  visit("leave", settings.leave);
  visit("rate_change", settings.rate_change);
  visit("near_views", settings.near_views);
  visit("establish_views", settings.establish_views);
  visit("establish_margin", settings.establish_margin);
  visit("establish_evidence", settings.establish_evidence);
  visit("support", settings.support);
  visit("present_support", settings.present_support);
}

/// Throws Error(usage) for settings out of range.
void check_filter(const FilterSettings& settings);

}  // namespace vpr
