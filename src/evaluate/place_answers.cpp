#include "evaluate/place_answers.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "truth/text_file.h"

namespace vpr {

void require_places(const Result& result) {
  if (!result.clusters)
    throw Error(ErrorKind::usage,
                "--places and --ask-places are for results with clusters of recognitions, and "
                "FAB-MAP has none. Use --ground-truth");
}

std::string answer_row(const Result& result, size_t cluster) {
  const Cluster& place = result.clusters->all[cluster];
  return fmt::format("{},{},{},{}", cluster + 1,
                     anchor_of(place.query_window, result.window_length()),
                     csv_field(result.sequences[place.sequence].sequence.name),
                     anchor_of(place.train_window, result.window_length()));
}

std::vector<PlaceLabel> read_place_answers(const std::filesystem::path& path,
                                           const Result& result) {
  require_places(result);
  NamedRows rows(path, path.string(), {"place", "query", "sequence", "train", "same"});
  if (rows.size() == 0)
    rows.fail("has no answers. Answer the page of vpr-eval --ask-places and save it again");
  const size_t places = result.clusters->all.size();
  std::vector<PlaceLabel> labels(places, PlaceLabel::ignore);
  while (rows.next()) {
    const auto place = parse_frame(rows.text("place"));
    const std::string found = fmt::format("{},{},{},{}", rows.text("place"), rows.text("query"),
                                          csv_field(rows.text("sequence")), rows.text("train"));
    if (!place || !place->in_range || place->value == 0 || place->value > places ||
        answer_row(result, place->value - 1) != found)
      rows.fail(
          fmt::format("the result has no place {}. The answers are of another result: repeat "
                      "--ask-places with this one",
                      found));
    PlaceLabel& label = labels[place->value - 1];
    const std::string& answer = rows.text("same");
    if (label != PlaceLabel::ignore)
      rows.fail(fmt::format("place {} has two answers. Remove one", place->value));
    if (answer != "yes" && answer != "no")
      rows.fail(fmt::format("\"same\" is \"{}\". Use yes or no, or remove the row", answer));
    label = answer == "yes" ? PlaceLabel::same : PlaceLabel::different;
  }
  return labels;
}

}  // namespace vpr
