#include "present/gallery.h"

#include <algorithm>
#include <mutex>
#include <span>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/text.h"
#include "recordings/frames.h"

namespace vpr {
namespace {

constexpr size_t kLeastApart = 5;

// The middle one of the correct references from frame `earliest` on.
std::optional<FrameMatch> middle_match(const GroundTruth& truth, const ScoreLayout& layout,
                                       size_t frame, size_t earliest) {
  std::vector<FrameMatch> correct;
  for (const GroundTruth::Pair& pair : truth.pairs[frame]) {
    const size_t end = std::min<size_t>(size_t{pair.last()} + 1,
                                        layout.scope.sequences[pair.sequence].sequence.frames);
    if (pair.label != PlaceLabel::same) continue;
    for (size_t train = std::max<size_t>(pair.first, earliest); train < end; ++train)
      correct.push_back({pair.sequence, train});
  }
  return correct.empty() ? std::nullopt : std::optional(correct[correct.size() / 2]);
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

void add_features(Thumbnail& thumbnail, const cv::Mat& image) {
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  const cv::Mat working = working_image(gray);
  thumbnail.features = find_local_features(working);
  thumbnail.working_side = std::max(working.cols, working.rows);
}

constexpr int kThumbnailSide = 160;  // pixels, of strips
constexpr int kSingleSide = 280;     // of single images

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

// The frames at a path of the run, if they are still the same.
template <class IsSame>
std::optional<SequenceSource> recorded_source(const std::string& path, const IsSame& is_same) {
  if (path.empty()) return std::nullopt;
  try {
    SequenceSource source = open_sequence(parse_sequence_argument(path));
    if (source.kind != SequenceKind::descriptors && is_same(source)) return source;
  } catch (const Error&) {  // they have moved
  }
  return std::nullopt;
}

bool has_names(const SequenceSource& source, const Sequence& expected) {
  std::vector<std::string> names = file_names(source);
  if (source.kind == SequenceKind::video) return true;
  if (names.size() != expected.recorded_frames()) return false;
  if (!expected.selection.is_all()) names = selected(std::move(names), expected.selection);
  return names == expected.frame_names;
}

// The run's database; without sequences if it has moved or changed, and without descriptors if it
// was in memory.
SequenceDatabase recorded_training(const ResultContext& context) {
  SequenceDatabase database;
  if (context.train) database.sequences = *context.train;
  const std::string path = context.train ? "" : context.run.path("database");
  if (path.empty()) return database;
  try {
    database = read_sequence_database(path);
    if (database.fingerprint == context.database_fingerprint) return database;
  } catch (const Error&) {  // it has moved
  }
  return {};
}

// Whether images, at most 256 and evenly spaced, have the stored descriptors of frames first,
// first + 1, ... of a database. Frames of videos, and of a database in memory, are not compared.
bool has_descriptors(const SequenceSource& source, const TrainSequence& train,
                     const SequenceDatabase& database, size_t first) {
  constexpr size_t kCompared = 256;
  const DescriptorRows rows = database.descriptors.rows();
  const size_t frames = train.sequence.frames;
  if (source.kind != SequenceKind::images || rows.size() < first + frames) return true;
  SequenceSource some = source;
  some.files.clear();
  std::vector<size_t> compared;
  for (size_t i = 0; i < std::min(kCompared, frames); ++i) {
    const size_t frame = i * frames / std::min(kCompared, frames);
    if (std::ranges::binary_search(train.sequence.unreadable, frame)) continue;
    compared.push_back(frame);
    some.files.push_back(source.files.at(train.sequence.selection.source_of(frame)));
  }
  if (compared.empty()) return true;
  const DescriptorSet found =
      database.descriptors.kind->describe(some, database.descriptor, Unreadable::fail, {});
  for (size_t i = 0; i < compared.size(); ++i)
    if (!std::ranges::equal(found.rows()[i], rows[first + compared[i]])) return false;
  return true;
}

// Evenly spaced queries, at most `most`, and their best matches.
ShownFrames pictured_frames(const Judgment& judgment, size_t most) {
  const auto& queries = judgment.outcomes.queries;
  ShownFrames shown;
  shown.references.resize(judgment.layout.scope.sequences.size());
  const size_t step = most == 0 ? 0 : (queries.size() + most - 1) / most;
  for (size_t q = 0; q < queries.size() && step > 0; q += step) {
    shown.query.insert(queries[q].frame);
    if (const auto& best = queries[q].best)
      shown.references[best->sequence].insert(best->reference);
  }
  return shown;
}

// The images of some of the frames.
FrameImages selected_images(const FrameImages& images, const ShownFrames& shown) {
  const auto select = [](const std::map<size_t, Thumbnail>& all, const std::set<size_t>& frames) {
    std::map<size_t, Thumbnail> some;
    for (const size_t frame : frames)
      if (const auto found = all.find(frame); found != all.end()) some.insert(*found);
    return some;
  };
  FrameImages some{select(images.query, shown.query), {}};
  for (size_t s = 0; s < images.references.size(); ++s)
    some.references.push_back(select(images.references[s], shown.references[s]));
  return some;
}

// The frames of cards, added to `shown`.
ShownFrames frames_of(const std::vector<GalleryItem>& items, const Judgment& judgment,
                      size_t strip_length, ShownFrames shown) {
  const auto add = [&](std::set<size_t>& frames, size_t anchor) {
    const auto strip = strip_frames(anchor, judgment.layout.window_length, strip_length);
    frames.insert(strip.begin(), strip.end());
  };
  for (const GalleryItem& item : items) {
    const QueryOutcome& outcome = judgment.outcomes.queries[item.query];
    add(shown.query, outcome.frame);
    add(shown.references[outcome.best->sequence], outcome.best->reference);
    if (item.truth) add(shown.references[item.truth->sequence], item.truth->reference);
  }
  return shown;
}

/// Each kind with its number of items, and of all queries from which they were chosen. The first
/// kind of an item is selected.
std::string kinds_html(const std::vector<GalleryItem>& items, const Judgment& judgment) {
  constexpr std::array<std::string_view, 3> kWords = {"worst mistakes", "strongest", "weakest"};
  const bool is_judged = judgment.by != JudgedBy::nothing;
  std::string html;
  for (size_t k = 0; k < kWords.size(); ++k) {
    const auto kind = static_cast<GalleryKind>(k);
    const auto count = std::ranges::count(items, kind, &GalleryItem::kind);
    if (count == 0) continue;
    const Verdict verdict = !is_judged                     ? Verdict::ignored
                            : kind == GalleryKind::mistake ? Verdict::incorrect
                                                           : Verdict::correct;
    html += fmt::format(
        "<label><input type=\"radio\" name=\"kind\" value=\"{}\"{}> {}{} ({} of {})</label>\n",
        enum_name(kind), kind == items.front().kind ? " checked" : "", kWords[k],
        is_judged && k > 0 ? " correct" : "", count,
        std::ranges::count(judgment.outcomes.queries, verdict, &QueryOutcome::verdict));
  }
  return html;
}

std::string gallery_note(const std::vector<GalleryItem>& items, const Judgment& judgment,
                         bool has_images) {
  if (items.empty())
    return judgment.by == JudgedBy::nothing ? "No query has a best match."
                                            : "No query has a best match that can be judged.";
  if (!has_images)
    return "The images of the run have moved or changed. Pass them with --query and --train, or "
           "--dataset.";
  return fmt::format(
      "One match per stretch of the path is shown before others, in the order of their {}. Those "
      "of one kind, except mistakes, are at least {} frames apart.",
      judgment.outcomes.confidence == Confidence::margin ? "margin" : "score",
      std::max(kLeastApart, judgment.layout.window_length));
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
    std::ranges::stable_sort(order, {}, [&](size_t q) {
      const uint64_t key = confidence_key(queries[q], judgment.outcomes.confidence);
      return is_best_first ? key : ~key;
    });
    const size_t begin = items.size();
    std::set<size_t> stretches;  // of the path, `most` of them, with an item
    for (size_t i = 0; i < 2 * order.size() && items.size() - begin < most; ++i) {
      const bool is_repeat = i >= order.size();
      const size_t q = order[i % order.size()];
      const bool is_near = std::any_of(items.begin(), items.end(), [&](const GalleryItem& item) {
        const size_t away = item.query > q ? item.query - q : q - item.query;
        return away == 0 || (kind != GalleryKind::mistake && item.kind == kind && away < apart);
      });
      if (is_near) continue;
      if (!stretches.insert(q * most / queries.size()).second && !is_repeat) continue;
      const size_t frame = queries[q].frame;
      auto match = middle_match(truth, judgment.layout, frame, judgment.layout.window_length - 1);
      if (!match) match = middle_match(truth, judgment.layout, frame, 0);  // without a whole window
      items.push_back({kind, q, match});
    }
  };
  const Verdict good = judgment.by == JudgedBy::nothing ? Verdict::ignored : Verdict::correct;
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
                                            const std::set<size_t>& wanted,
                                            const ThumbnailSettings& settings,
                                            const Monitor& monitor) {
  std::map<size_t, std::vector<size_t>> frames;  // by frame of the recording
  for (const size_t frame : wanted) frames[selection.source_of(frame)].push_back(frame);
  std::map<size_t, Thumbnail> found;
  if (frames.empty()) return found;
  std::mutex mutex;
  const auto keep = [&](size_t source, const std::string& name, const cv::Mat& image) {
    Thumbnail thumbnail{name, {}};
    if (!image.empty()) thumbnail.jpeg = small_jpeg(image, settings.side);
    if (!image.empty() && settings.has_features) add_features(thumbnail, image);
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

FrameImages read_images(const ShownFrames& frames, const GroundTruthScope& scope,
                        const FrameSources& sources, const ThumbnailSettings& settings,
                        const Monitor& monitor) {
  FrameImages images;
  images.references.resize(frames.references.size());
  if (sources.query)
    images.query =
        make_thumbnails(*sources.query, scope.query.selection, frames.query, settings, monitor);
  for (size_t s = 0; s < sources.references.size(); ++s)
    if (sources.references[s])
      images.references[s] =
          make_thumbnails(*sources.references[s], scope.sequences[s].sequence.selection,
                          frames.references[s], settings, monitor);
  return images;
}

Json images_json(const FrameImages& images) {
  Json json = Json::object();
  const auto add = [&](const std::string& prefix, const std::map<size_t, Thumbnail>& thumbnails) {
    for (const auto& [frame, image] : thumbnails)
      json[fmt::format("{} {}", prefix, frame)] = {
          image.jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(image.jpeg), image.name};
  };
  add("query", images.query);
  for (size_t s = 0; s < images.references.size(); ++s)
    add(std::to_string(s), images.references[s]);
  return json;
}

FrameSources recorded_frames(const GroundTruthScope& scope, const StoredResult* stored) {
  FrameSources sources{{}, std::vector<std::optional<SequenceSource>>(scope.sequences.size())};
  if (stored == nullptr) return sources;
  const ResultContext& context = stored->context;
  sources.query = recorded_source(context.run.path("query"), [&](const SequenceSource& source) {
    const auto images = context.run.images.find("query");
    const std::string sum = images == context.run.images.end() ? "" : images->second;
    return images_checksum(source) == sum;
  });
  if (stored->result.places) return sources;
  if (is_loop(stored->result.settings)) {
    sources.references.assign(scope.sequences.size(), sources.query);
    return sources;
  }
  const SequenceDatabase database = recorded_training(context);
  size_t first = 0;
  for (size_t s = 0; s < std::min(scope.sequences.size(), database.sequences.size()); ++s) {
    const TrainSequence& train = database.sequences[s];
    sources.references[s] = recorded_source(train.path, [&](const SequenceSource& source) {
      return has_names(source, train.sequence) && has_descriptors(source, train, database, first);
    });
    first += train.sequence.frames;
  }
  return sources;
}

Gallery make_gallery(const Judgment& judgment, const GroundTruth& truth, const ScoreUnit& unit,
                     const FrameSources& sources, const Monitor& monitor, const GallerySize& size) {
  std::vector<GalleryItem> items = choose_gallery(judgment, truth, size.cards_of_a_kind);
  if (items.size() > size.cards) items.resize(size.cards);
  const ScoreLayout& layout = judgment.layout;
  const ShownFrames pictured = pictured_frames(judgment, size.pictured);
  const FrameImages images = read_images(
      frames_of(items, judgment, size.strip_frames, pictured), layout.scope, sources,
      {layout.window_length == 1 ? kSingleSide : kThumbnailSide, size.has_features}, monitor);
  const auto frames_at = [&](size_t anchor) {
    return strip_frames(anchor, layout.window_length, size.strip_frames);
  };
  const bool is_judged = judgment.by != JudgedBy::nothing;
  Gallery gallery;
  gallery.kinds = kinds_html(items, judgment);
  gallery.note = gallery_note(items, judgment, sources.query.has_value());
  gallery.pictured = selected_images(images, pictured);
  for (const GalleryItem& item : items) {
    const QueryOutcome& outcome = judgment.outcomes.queries[item.query];
    // The best match of a correct one is a true place.
    const bool shows_truth =
        item.truth && size.has_true_place && outcome.verdict != Verdict::correct;
    const char* verdict = !is_judged                            ? ""
                          : outcome.verdict == Verdict::correct ? "correct: "
                                                                : "incorrect: ";
    gallery.cards += fmt::format(
        "<article class=\"card {0}{1}{5}\" data-at=\"{4}\" "
        "tabindex=\"0\"><h3>{2}query {3}</h3>",
        enum_name(item.kind), is_judged ? "" : " unjudged", verdict, outcome.frame, item.query,
        shows_truth ? "" : " two");
    gallery.cards += fmt::format(
        "<p>{}{} {:.4g}{}{}</p>",
        outcome.margin ? fmt::format("margin {:.4g}, ", *outcome.margin) : "", unit.words,
        score_of_key(outcome.key, judgment.outcomes.kind) / unit.divisor,
        is_recognized(judgment, outcome) ? ", recognized" : ", not recognized",
        item.truth || !truth.is_known || !size.has_true_place ? ""
                                                              : "; the ground truth has no match");
    const auto add_strip = [&](const char* title, const FrameMatch& match) {
      gallery.cards +=
          strip(fmt::format("{} {} {}", title, layout.scope.sequences[match.sequence].sequence.name,
                            match.reference),
                frames_at(match.reference), images.references[match.sequence]);
    };
    gallery.cards +=
        strip(fmt::format("query {}", outcome.frame), frames_at(outcome.frame), images.query);
    add_strip("match", *outcome.best);
    if (shows_truth) add_strip("truth", *item.truth);
    gallery.cards += "</article>\n";
  }
  return gallery;
}

}  // namespace vpr
