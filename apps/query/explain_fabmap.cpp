#include "explain_fabmap.h"

#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "present/explanation_report.h"
#include "present/raster.h"
#include "present/result_file.h"
#include "sequence/sequence_source.h"

namespace vpr {

std::filesystem::path explanation_picture_path(const std::string& output) {
  return companion_path(output, "explain.png");
}

std::map<size_t, SequenceArgument> images_by_group(const QueryInputs& inputs,
                                                   const FabmapDatabase& database) {
  std::map<size_t, SequenceArgument> images;
  for (const std::string& text : inputs.train_images) {
    // A path that exists as it is wins over a group's name.
    const bool is_path = std::filesystem::exists(parse_sequence_argument(text).path);
    const size_t equals = is_path ? std::string::npos : text.find('=');
    const SequenceArgument argument =
        parse_sequence_argument(equals == std::string::npos ? text : text.substr(equals + 1));
    const std::string name =
        equals == std::string::npos ? sequence_names({argument}).front() : text.substr(0, equals);
    size_t group = 0;
    while (group < database.groups.size() &&
           (database.groups[group].sequence.name != name || images.contains(group)))
      ++group;
    if (group == database.groups.size())
      throw Error(ErrorKind::usage,
                  fmt::format("--train-images: the database has no further group named {}; "
                              "vpr-train info lists them",
                              name));
    images[group] = argument;
  }
  return images;
}

void write_explanation_picture(const Explanation& explanation, const QueryInputs& inputs,
                               const FrameOfQuery& query, const FabmapDatabase& searched,
                               bool searches_query, const Session& session) {
  std::map<size_t, SequenceArgument> images = images_by_group(inputs, searched);
  if (searches_query) images[searched.groups.size() - 1] = query.sequence;
  const FrameFeatures frame =
      locate_words(open_sequence(query.sequence), query.frame, searched, session.monitor);
  std::vector<ImagePair> pairs;
  for (const PlaceExplanation& place : explanation.places) {
    ImagePair& pair = pairs.emplace_back();
    pair.query = mark_words(frame, place, fmt::format("query frame {}", explanation.frame));
    pair.view.title = fmt::format("{}, probability {:.4f}, log-odds {:+.2f}", place.place,
                                  place.match.score, place.log_odds);
    const ViewOrigin origin = searched.origin(place.match.view);
    const auto source = images.find(origin.group);
    if (source == images.end()) {
      pair.view.title += " (its images: --train-images)";
      continue;
    }
    try {
      const FrameFeatures view =
          locate_words(open_sequence(source->second), origin.frame, searched, session.monitor);
      pair.view = mark_words(view, place, pair.view.title);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      pair.view.title += " (can't be decoded)";
    }
  }
  session.outputs.file(explanation_picture_path(session.options.output))
      .write(png_of(draw_word_pairs(pairs)));
}

}  // namespace vpr
