#include "present/evaluation_page.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/json_fields.h"
#include "base/parallel.h"
#include "evaluate/metrics.h"
#include "present/chart.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_report.h"
#include "present/html_page.h"
#include "present/score_matrix.h"
#include "sequence/frames.h"

namespace vpr {
namespace {

// The files of src/present/html as string constants.
#include "html_parts.inc"

constexpr size_t kLeastApart = 5;

// The middle one of the correct references from frame `earliest` on.
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

std::vector<std::byte> small_jpeg(const cv::Mat& image, int side) {
  const double scale = std::min(1.0, double(side) / std::max({image.cols, image.rows, 1}));
  const cv::Size size(std::max(1, cvRound(image.cols * scale)),
                      std::max(1, cvRound(image.rows * scale)));
  cv::Mat resized;
  cv::resize(image, resized, size, 0, 0, cv::INTER_AREA);
  std::vector<uint8_t> jpeg;
  cv::imencode(".jpg", resized, jpeg, {cv::IMWRITE_JPEG_QUALITY, 70});
  const auto bytes = std::as_bytes(std::span(jpeg));
  return {bytes.begin(), bytes.end()};
}

constexpr size_t kMostItems = 18;  // per kind
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
      html += "<span class=\"gone\">no image</span>";
    else
      html += fmt::format("<img alt=\"frame {}\" title=\"{}\" src=\"data:image/jpeg;base64,{}\">",
                          frame, html_escaped(found->second.name), base64(found->second.jpeg));
  }
  return html + "</div></figure>";
}

constexpr size_t kMatrixSide = 800;  // pixels
constexpr size_t kMostPoints = 300;  // of curves in the data
constexpr std::string_view kMistakes =
    "<label><input type=\"radio\" name=\"kind\" value=\"mistake\"> worst mistakes</label>";
constexpr std::string_view kDisagreements =
    "<button type=\"button\" id=\"next-disagreement\">next disagreement (n)</button>\n"
    "<button type=\"button\" id=\"save-disagreements\">save disagreements.csv</button>";

struct PageCharts {
  Chart curve;
  Chart risk;
  Chart thresholds;
  Chart timeline;
  Chart matrix;
};

bool by_margin(const Judgment& judgment) {
  return judgment.outcomes.confidence == Confidence::margin;
}

/// "0.031", or "0.031 by score, 0.012 by margin".
std::string risk_areas(const Judgment& judgment) {
  const auto area = [](const Curve& curve) {
    const auto value = risk_coverage_area(curve).value;
    return value ? fmt::format("{:.3f}", *value) : std::string("not defined");
  };
  const std::string single = area(judgment.single_best);
  if (!judgment.other_best) return single;
  const std::string other = area(*judgment.other_best);
  return fmt::format("{} by score, {} by margin", by_margin(judgment) ? other : single,
                     by_margin(judgment) ? single : other);
}

PageCharts page_charts(const Evaluation& evaluation, const Report& report, const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  PageCharts charts = {curve_chart(report, judgment), risk_chart(report, judgment),
                       threshold_chart(report, judgment),
                       timeline_chart(report, judgment, evaluation.truth, monitor),
                       matrix_chart(evaluation, report, kMatrixSide, monitor)};
  charts.curve.title = "Precision and recall";
  charts.risk.title = "Risk and coverage: area " + risk_areas(judgment);
  charts.thresholds.title =
      by_margin(judgment) ? "Recognitions by margin" : "Recognitions by threshold";
  for (Chart* chart : {&charts.curve, &charts.risk, &charts.thresholds}) {
    chart->width = 650;
    chart->height = 450;
  }
  charts.timeline.title = "best match of every query frame";
  charts.timeline.height = 440;
  charts.matrix.title = "queries against references";
  return charts;
}

/// The slider of the page belongs to the last chart.
std::string curves_html(const PageCharts& charts) {
  std::string html = "<div class=\"charts\">";
  for (const Chart* chart : {&charts.curve, &charts.risk, &charts.thresholds})
    if (!chart->series.empty() || chart == &charts.thresholds)
      html += figure_html(chart->title, *chart, legend_html(meanings_of(*chart)));
  return html + "</div>";
}

/// Empty if margins are unknown.
std::string margins_html(const Report& report, const Judgment& judgment) {
  Chart chart = margin_chart(report, judgment);
  if (chart.series.empty()) return "";
  chart.title = "margin of every query frame's best match";
  chart.height = 300;
  return "<h3>Margins: difference to the runner-up</h3>\n<p class=\"legend\">" +
         legend_html(meanings_of(chart)) + "</p>" +
         scrolling_html(html_escaped(chart.title), page_svg(chart)) + "\n";
}

std::string tables_html(const Report& report, bool is_judged) {
  if (!is_judged) return table_html(unjudged_table(report));
  Table summary = report_table(report);
  summary.title = "Counts";
  std::string html = table_html(summary);
  for (const Table& table : metrics_tables(report)) html += table_html(table);
  return html;
}

Json area_json(const Chart& chart) {
  const ChartLayout layout = layout_of(chart, true);
  const auto scale = [](const AxisScale& axis) {
    return Json{axis.from, axis.to, axis.begin, axis.end};
  };
  return {{"width", layout.width}, {"x", scale(layout.x)}, {"y", scale(layout.y)}};
}

Json bands_json(const std::vector<FrameBand>& bands) {
  Json json = Json::array();
  for (const FrameBand& band : bands)
    json.push_back({{"sequence", band.sequence},
                    {"at", band.at},
                    {"first", band.first_frame},
                    {"count", band.count}});
  return json;
}

void add_queries(Json& data, const Judgment& judgment) {
  data["matches"] = Json::array();
  data["scores"] = Json::array();
  Json ranks = Json::array();
  std::string recognized(judgment.verdicts.size(), '.');
  for (const QueryOutcome& query : judgment.outcomes.queries) {
    data["matches"].push_back(
        query.best ? Json::array({query.best->sequence, query.best->reference}) : Json());
    data["scores"].push_back(
        query.best ? Json(fmt::format("{:.6g}", score_of_key(query.key, judgment.outcomes.kind)))
                   : Json());
    ranks.push_back(query.rank.value_or(0));
    if (is_recognized(judgment, query)) recognized[query.frame] = 'f';
  }
  if (judgment.outcomes.has_ranks) data["ranks"] = ranks;
  data["recognized"] = recognized;
}

/// The margin of the decision; null for decisions without margin, and if it differs by sequence.
Json required_margin(const Outcomes& outcomes) {
  std::optional<double> required;
  if (outcomes.confidence == Confidence::score) return {};
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.required_margin) continue;
    if (required && *required != *query.required_margin) return {};
    required = query.required_margin;
  }
  return or_null(required);
}

/// For each selected frame, its frame of the recording.
void add_sources(Json& data, const GroundTruthScope& scope) {
  const auto is_all = [](const auto& train) { return train.sequence.selection.is_all(); };
  if (const Selection& selection = scope.query.selection; !selection.is_all())
    data["query_sources"] = selection.sources;
  if (std::ranges::all_of(scope.sequences, is_all)) return;
  for (const auto& train : scope.sequences)
    data["train_sources"].push_back(is_all(train) ? Json()
                                                  : Json(train.sequence.selection.sources));
}

/// Values per query, the scales of all charts (from, to, and begin and end in units of the SVG),
/// the bands of their axes, points of the curve, and counts by threshold.
Json page_data(const Report& report, const Judgment& judgment, bool is_judged,
               const PageCharts& charts) {
  Json data;
  data["best"] = outcome_letters(report.outcomes);
  data["first_frame"] = report.outcomes.window_length - 1;
  data["kind"] = score_words(report);
  data["judged"] = is_judged;
  data["sequences"] = Json::array();
  for (const auto& train : judgment.layout.scope.sequences)
    data["sequences"].push_back(train.sequence.name);
  add_queries(data, judgment);
  add_sources(data, judgment.layout.scope);
  data["areas"] = {{"timeline", area_json(charts.timeline)},
                   {"matrix", area_json(charts.matrix)},
                   {"thresholds", area_json(charts.thresholds)},
                   {"precision-recall", area_json(charts.curve)}};
  data["frames"] = bands_json(frame_bands(judgment.layout));
  data["columns"] = bands_json(column_bands(judgment.layout));
  data["rows"] = bands_json(row_bands(judgment.layout));
  data["to_find"] = judgment.single_best.to_find;
  data["curve"] = curve_points(judgment.single_best, kMostPoints);
  data["steps"] = Json::array();
  for (const ThresholdStep& step : threshold_steps(report, judgment, kMostPoints))
    data["steps"].push_back({step.threshold, step.accepted[0], step.accepted[1], step.accepted[2]});
  data["order"] = enum_name(confidence_order(judgment.outcomes));
  data["asked"] = required_margin(judgment.outcomes);
  return data;
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
      if (is_near) continue;
      const size_t frame = queries[q].frame;
      auto match = middle_match(truth, judgment.layout, frame, judgment.layout.window_length - 1);
      if (!match) match = middle_match(truth, judgment.layout, frame, 0);  // without a whole window
      items.push_back({kind, q, match});
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

std::map<size_t, Thumbnail> make_thumbnails(const SequenceSource& recording,
                                            const Selection& selection,
                                            const std::set<size_t>& wanted, int side,
                                            const Monitor& monitor) {
  std::map<size_t, std::vector<size_t>> frames;  // by frame of the recording
  for (const size_t frame : wanted)
    frames[selection.is_all() ? frame : selection.sources[frame]].push_back(frame);
  std::map<size_t, Thumbnail> found;
  if (frames.empty()) return found;
  std::mutex mutex;
  const auto keep = [&](size_t source, const std::string& name, const cv::Mat& image) {
    const Thumbnail thumbnail{name,
                              image.empty() ? std::vector<std::byte>{} : small_jpeg(image, side)};
    const std::scoped_lock lock(mutex);
    for (const size_t frame : frames.at(source)) found[frame] = thumbnail;
  };
  if (recording.kind != SequenceKind::images) {
    for_each_frame(recording, PixelFormat::bgr, Unreadable::skip, monitor,
                   [&](size_t index, const cv::Mat& image) {
                     if (frames.contains(index)) keep(index, fmt::format("#{}", index), image);
                   });
    return found;
  }
  std::vector<size_t> order;
  for (const auto& [source, selected] : frames) order.push_back(source);
  parallel_for(order.size(), monitor, [&](size_t i) {
    if (order[i] >= recording.files.size()) return;
    const auto& file = recording.files[order[i]];
    cv::Mat image;
    try {
      image = decode_image(file, PixelFormat::bgr);
    } catch (const Error&) {  // the page shows a gap
    }
    keep(order[i], file.filename().string(), image);
  });
  return found;
}

namespace {

struct GalleryImages {
  std::map<size_t, Thumbnail> query;
  std::vector<std::map<size_t, Thumbnail>> references;  ///< by sequence
};

GalleryImages read_images(const std::vector<GalleryItem>& items, const Judgment& judgment,
                          const FrameSources& sources, const Monitor& monitor) {
  const GroundTruthScope& scope = judgment.layout.scope;
  std::set<size_t> query;
  std::vector<std::set<size_t>> references(scope.sequences.size());
  const auto add = [&](std::set<size_t>& frames, size_t anchor) {
    const auto strip = strip_frames(anchor, judgment.layout.window_length, kStripFrames);
    frames.insert(strip.begin(), strip.end());
  };
  for (const GalleryItem& item : items) {
    const QueryOutcome& outcome = judgment.outcomes.queries[item.query];
    add(query, outcome.frame);
    add(references[outcome.best->sequence], outcome.best->reference);
    if (item.truth) add(references[item.truth->sequence], item.truth->reference);
  }
  GalleryImages images{{}, std::vector<std::map<size_t, Thumbnail>>(references.size())};
  if (sources.query)
    images.query =
        make_thumbnails(*sources.query, scope.query.selection, query, kThumbnailSide, monitor);
  for (size_t s = 0; s < sources.references.size(); ++s)
    if (sources.references[s])
      images.references[s] =
          make_thumbnails(*sources.references[s], scope.sequences[s].sequence.selection,
                          references[s], kThumbnailSide, monitor);
  return images;
}

struct Gallery {
  std::string note;   ///< a plain sentence
  std::string cards;  ///< HTML elements
};

Gallery make_gallery(const Judgment& judgment, const GroundTruth& truth,
                     const FrameSources& sources, const Monitor& monitor) {
  const std::vector<GalleryItem> items = choose_gallery(judgment, truth, kMostItems);
  const GalleryImages images = read_images(items, judgment, sources, monitor);
  const ScoreLayout& layout = judgment.layout;
  const auto frames_at = [&](size_t anchor) {
    return strip_frames(anchor, layout.window_length, kStripFrames);
  };
  Gallery gallery;
  for (const GalleryItem& item : items) {
    const QueryOutcome& outcome = judgment.outcomes.queries[item.query];
    const char* verdict = !truth.is_known                       ? ""
                          : outcome.verdict == Verdict::correct ? "right: "
                                                                : "wrong: ";
    gallery.cards += fmt::format(
        "<article class=\"card {0}{1}\" data-kind=\"{0}\" data-at=\"{4}\" "
        "tabindex=\"0\"><h3>{2}query {3}</h3>",
        enum_name(item.kind), truth.is_known ? "" : " unjudged", verdict, outcome.frame,
        item.query);
    gallery.cards +=
        fmt::format("<p>{} {:.6g}{}{}</p>", enum_name(judgment.outcomes.kind),
                    score_of_key(outcome.key, judgment.outcomes.kind),
                    is_recognized(judgment, outcome) ? ", recognized" : ", not recognized",
                    item.truth || !truth.is_known ? "" : "; the ground truth has no match");
    const auto add_strip = [&](const char* title, const FrameMatch& match) {
      gallery.cards +=
          strip(fmt::format("{} {} {}", title, layout.scope.sequences[match.sequence].sequence.name,
                            match.reference),
                frames_at(match.reference), images.references[match.sequence]);
    };
    gallery.cards +=
        strip(fmt::format("query {}", outcome.frame), frames_at(outcome.frame), images.query);
    add_strip("best match", *outcome.best);
    if (item.truth) add_strip("true place", *item.truth);
    gallery.cards += "</article>\n";
  }
  if (items.empty())
    gallery.note = truth.is_known ? "No query has a best match that can be judged."
                                  : "No query has a best match.";
  else
    gallery.note = fmt::format(
        "At most {} of each kind, of queries at least a window apart. Arrow keys go from one to "
        "the next, / to the search.{}",
        kMostItems,
        sources.query ? "" : " Give the sequences (--query, --train or --dataset) for images.");
  return gallery;
}

}  // namespace

std::string evaluation_page(const Evaluation& evaluation, const Report& report, const RunInfo& run,
                            const std::string& summary, const FrameSources& sources,
                            const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const GroundTruth& truth = evaluation.truth;
  const Gallery gallery = make_gallery(judgment, truth, sources, monitor);
  const PageCharts charts = page_charts(evaluation, report, monitor);
  Json json = report_json(report);
  Json made = json["settings"];
  made.update(json["provenance"]);
  if (!run.command_line.empty()) made["command_line"] = run.command_line;
  Json& protocol = json["protocol"];
  protocol.erase("ground_truth");  // the subtitle
  if (truth.is_known)
    protocol.erase("localization");  // the title of its table
  else
    for (const char* key :
         {"tolerance_frames", "distinct", "best_match", "no_ground_truth", "single_best"})
      protocol.erase(key);  // without meaning for matches that are not judged
  return fill_page(
      kPage,
      {{"title", html_escaped(evaluation_title(report))},
       {"summary", html_escaped(summary)},
       {"subtitle", html_escaped("Ground truth: " + truth.protocol)},
       {"style", palette_css() + std::string(kStyle)},
       {"script", fmt::format("{}{}{}", kScript, kHoverScript, kLabelScript)},
       {"disagreements", truth.is_known ? std::string(kDisagreements) : ""},
       {"tables", tables_html(report, truth.is_known)},
       {"protocol", list_html(protocol)},
       {"provenance", list_html(made)},
       {"curves", curves_html(charts)},
       {"threshold", by_margin(judgment) ? "Margin" : "Threshold"},
       {"timeline_legend", legend_html(meanings_of(charts.timeline))},
       {"timeline", page_svg(charts.timeline)},
       {"margins", margins_html(report, judgment)},
       {"matrix_title", evaluation.matrix ? "Scores of all pairs" : "Recognitions of all pairs"},
       {"matrix_legend", legend_html(meanings_of(charts.matrix))},
       {"matrix", page_svg(charts.matrix)},
       {"gallery_title", truth.is_known ? "Mistakes and recognitions" : "Best matches"},
       {"mistakes", truth.is_known ? std::string(kMistakes) : ""},
       {"weak", truth.is_known ? "weakest right ones" : "weakest matches"},
       {"gallery_note", html_escaped(gallery.note)},
       {"cards", gallery.cards},
       {"data", script_json(page_data(report, judgment, truth.is_known, charts))}});
}

}  // namespace vpr
