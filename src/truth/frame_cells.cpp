#include "truth/frame_cells.h"

#include <algorithm>

namespace vpr {

namespace {

/// The numbers of a column.
struct Digits {
  FrameCells* column;
  bool are_all = true;  // cells of the column
  size_t named = 0;
  std::string_view moved;     // the first one that is the name of another frame
  std::string_view unnamed;   // the first one that is not a name
  bool count_frames = false;  // from 0, which is not a name

  explicit Digits(FrameCells& cells) : column(&cells) {
    for (const std::string_view text : cells.texts) {
      const auto number = parse_frame(text);
      are_all = are_all && number;
      if (!no_number_hint(text).empty()) cells.are_names = true;
      if (!number) continue;
      const auto frame = cells.names == nullptr ? std::nullopt : cells.names->find(text);
      named += frame ? 1 : 0;
      if (frame && moved.empty() && *frame != number->value) moved = text;
      if (!frame && unnamed.empty()) unnamed = text;
      count_frames = count_frames || (cells.names != nullptr && !frame && number->value == 0);
    }
    count_frames = count_frames && are_all;
  }
};

}  // namespace

void find_names(std::span<FrameCells> columns, const FileLocation& file, std::string_view advice,
                const Monitor& monitor) {
  const std::vector<Digits> all(columns.begin(), columns.end());
  const bool count_frames = std::ranges::any_of(all, &Digits::count_frames);
  for (const Digits& digits : all) {
    FrameCells& column = *digits.column;
    if (column.are_names || digits.moved.empty() || (digits.are_all && count_frames)) continue;
    column.are_names = digits.unnamed.empty();
    if (digits.are_all && !column.are_names && 2 * digits.named <= column.texts.size()) continue;
    const auto other = std::ranges::find_if(all, [&](const Digits& one) {
      return !one.unnamed.empty() && (one.column == &column || (one.are_all && digits.are_all));
    });
    if (other != all.end())
      file.fail(
          "{} {} is the number of one frame and the name of another, {}, but {} {} is not a name. "
          "Write names with their extension. {}",
          column.what, digits.moved, *column.names->find(digits.moved), other->column->what,
          other->unnamed, advice);
    if (digits.are_all)
      warn(monitor,
           "{}: {} is read as the name of frame {}, because every cell of its column is a name. {}",
           file.file, digits.moved, *column.names->find(digits.moved), advice);
  }
}

std::vector<std::optional<size_t>> entries_by_frame(const FrameNames& frames,
                                                    std::span<const std::string> names,
                                                    std::span<const size_t> lines,
                                                    const std::string& file) {
  std::vector<std::optional<size_t>> entries(frames.count());
  for (size_t i = 0; i < names.size(); ++i) {
    const auto frame = names[i].empty() ? std::nullopt : frames.find(names[i]);
    if (!frame) continue;  // of another sequence
    if (entries[*frame])
      FileLocation{file, "line", lines[i]}.fail("the image {} is listed twice", names[i]);
    entries[*frame] = i;
  }
  return entries;
}

}  // namespace vpr
