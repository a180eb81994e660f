#include "evaluate/place_answers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/rows.h"
#include "base/text.h"
#include "evaluate/judgment.h"

namespace vpr {
namespace {

constexpr size_t kAround = 10;        // frames on both sides of a change
constexpr double kSpeedChange = 0.5;  // training frames per query frame
constexpr double kScoreChange = 3;    // standard deviations of the scores on both sides

/// The best recognition of a place at a query frame.
struct PathPoint {
  double query = 0;
  double train = 0;
  double score = 0;
};

MatchedFrame middle_of(const Cluster& cluster, size_t length) {
  return {anchor_of(cluster.query_window, length),
          {cluster.sequence, anchor_of(cluster.train_window, length)}};
}

// Query frames between the middles.
size_t away(const PlacePart& a, const PlacePart& b) {
  return std::max(a.middle.query, b.middle.query) - std::min(a.middle.query, b.middle.query);
}

double speed_of(std::span<const PathPoint> points) {
  return (points.back().train - points.front().train) /
         std::max(1.0, points.back().query - points.front().query);
}

// Mean and variance.
std::pair<double, double> mean_and_variance(std::span<const PathPoint> points) {
  double sum = 0;
  double squares = 0;
  for (const PathPoint& point : points) {
    sum += point.score;
    squares += point.score * point.score;
  }
  const auto n = static_cast<double>(points.size());
  return {sum / n, std::max(0.0, squares / n - sum / n * (sum / n))};
}

// How far speed and score change at point `at`, 1 being a change; 0 near the ends.
double change_at(std::span<const PathPoint> points, size_t at) {
  if (at < kAround || at + kAround > points.size()) return 0;
  const auto before = points.subspan(at - kAround, kAround);
  const auto after = points.subspan(at, kAround);
  const double speed = std::abs(speed_of(before) - speed_of(after)) / kSpeedChange;
  const auto [mean_before, variance_before] = mean_and_variance(before);
  const auto [mean_after, variance_after] = mean_and_variance(after);
  const double deviation = std::sqrt((variance_before + variance_after) / 2);
  const double score = std::abs(mean_before - mean_after) / (kScoreChange * deviation);
  return std::max(speed, deviation > 0 ? score : 0);
}

// The first points of all parts.
std::vector<size_t> cuts_of(std::span<const PathPoint> points) {
  std::vector<double> changes;
  for (size_t at = 0; at < points.size(); ++at) changes.push_back(change_at(points, at));
  std::vector<size_t> changed = {0};
  for (size_t at = 0; at < points.size(); ++at) {
    const size_t end = std::min(points.size(), at + kAround);
    const auto largest = std::max_element(changes.begin() + static_cast<ptrdiff_t>(at),
                                          changes.begin() + static_cast<ptrdiff_t>(end));
    if (changes[at] < 1 || *largest > changes[at] || at - changed.back() < kAround) continue;
    changed.push_back(at);
  }
  changed.push_back(points.size());
  std::vector<size_t> cuts;
  for (size_t c = 0; c + 1 < changed.size(); ++c) {
    const size_t frames = changed[c + 1] - changed[c];
    const size_t parts = (frames + kPartFrames - 1) / kPartFrames;
    for (size_t part = 0; part < parts; ++part) cuts.push_back(changed[c] + part * frames / parts);
  }
  return cuts;
}

}  // namespace

std::vector<PlacePart> parts_of_places(const Result& result) {
  require_places(result);
  const size_t length = result.window_length();
  std::vector<std::vector<uint32_t>> of_place(result.clusters->all.size());
  for (uint32_t r = 0; r < result.recognitions.size(); ++r)
    of_place[result.clusters->of_recognition[r]].push_back(r);
  std::vector<PlacePart> all;
  for (size_t place = 0; place < of_place.size(); ++place) {
    const auto query_of = [&](uint32_t r) { return result.recognitions[r].query; };
    std::vector<uint32_t>& members = of_place[place];
    std::ranges::stable_sort(members, {}, query_of);
    std::vector<PathPoint> points;
    std::vector<uint32_t> best;  // recognition by point
    for (const uint32_t r : members) {
      const Match& match = result.recognitions[r];
      if (best.empty() || query_of(best.back()) != match.query) {
        best.push_back(r);
        points.emplace_back();
      } else if (is_better(match.score, points.back().score, result.score().order)) {
        best.back() = r;
      } else {
        continue;
      }
      points.back() = {static_cast<double>(match.query), static_cast<double>(match.train),
                       match.score};
    }
    std::vector<size_t> cuts = cuts_of(points);
    cuts.push_back(points.size());
    size_t next = 0;  // of members
    for (size_t c = 0; c + 1 < cuts.size(); ++c) {
      PlacePart& part = all.emplace_back(PlacePart{place, {}, cuts[c + 1] - cuts[c], {}});
      const uint32_t last = query_of(best[cuts[c + 1] - 1]);
      while (next < members.size() && query_of(members[next]) <= last)
        part.recognitions.push_back(members[next++]);
      const Match& middle = result.recognitions[best[(cuts[c] + cuts[c + 1]) / 2]];
      part.middle = cuts.size() > 2 ? anchors_of(middle, length)
                                    : middle_of(result.clusters->all[place], length);
    }
  }
  return all;
}

void require_places(const Result& result) {
  if (!result.clusters)
    throw Error(ErrorKind::usage,
                "--places and --ask-places are for results with clusters of recognitions, and "
                "FAB-MAP has none. Use --ground-truth");
}

std::string answer_row(const Result& result, const PlacePart& part) {
  const auto& [query, match] = part.middle;
  return fmt::format("{},{},{},{}", part.place + 1, query,
                     csv_field(result.sequences[match.sequence].sequence.name), match.reference);
}

std::vector<PlaceLabel> read_place_answers(const std::filesystem::path& path, const Result& result,
                                           const std::vector<PlacePart>& parts) {
  Rows rows(path, path.string(), {{"place", "query", "sequence", "train", "same"}, 5});
  if (rows.size() == 0)
    rows.fail("has no answers. Answer the page of vpr-eval --ask-places and save it again");
  std::vector<PlaceLabel> labels(parts.size(), PlaceLabel::ignore);
  std::map<std::string, size_t> by_row;
  for (size_t p = 0; p < parts.size(); ++p) by_row[answer_row(result, parts[p])] = p;
  // The middle of a place, as reports have it, stands for the part around it.
  for (size_t p = 0; p < parts.size();) {
    const size_t place = parts[p].place;
    const PlacePart whole{
        place, {}, 0, middle_of(result.clusters->all[place], result.window_length())};
    size_t nearest = p;
    for (; p < parts.size() && parts[p].place == place; ++p)
      if (away(parts[p], whole) < away(parts[nearest], whole)) nearest = p;
    by_row.emplace(answer_row(result, whole), nearest);
  }
  while (rows.next()) {
    const std::string row = fmt::format("{},{},{},{}", rows.text("place"), rows.text("query"),
                                        csv_field(rows.text("sequence")), rows.text("train"));
    const auto part = by_row.find(row);
    if (part == by_row.end())
      rows.fail(
          "the result has no place {}. The answers are of another result: repeat --ask-places with "
          "this one",
          row);
    PlaceLabel& label = labels[part->second];
    const std::string_view answer = rows.text("same");
    if (label != PlaceLabel::ignore)
      rows.fail("place {} has two answers. Remove one", parts[part->second].place + 1);
    if (answer != "yes" && answer != "no")
      rows.fail("\"same\" is \"{}\". Use yes or no, or remove the row", answer);
    label = answer == "yes" ? PlaceLabel::same : PlaceLabel::different;
  }
  return labels;
}

}  // namespace vpr
