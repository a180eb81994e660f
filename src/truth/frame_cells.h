// Cells that refer to frames by their number or their name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "base/rows.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// The cells of a column that refer to the frames of one side, each by its number or its name.
struct FrameCells {
  std::string_view what;              ///< such as "query"
  const FrameNames* names = nullptr;  ///< null: unknown
  std::vector<std::string_view> texts = {};
  bool are_names = false;  ///< numbers as well; set by find_names
};

/// Decides for all columns of a file whether numbers are names. They are if every cell of the
/// column is a name, and nothing shows that the file counts frames: a 0 that is not a name. Warns
/// where both readings are possible. Throws Error(data) if columns or cells contradict each other;
/// `advice` says how to state that they are numbers.
void find_names(std::span<FrameCells> columns, const FileLocation& file, std::string_view advice,
                const Monitor& monitor);

/// For each of the frames, the entry of a file that has its name; nullopt: none has. Entries may
/// name frames of other sequences, or none (empty). Throws Error(data), with its line, for a second
/// entry of a frame. `lines`: of the entries.
std::vector<std::optional<size_t>> entries_by_frame(const FrameNames& frames,
                                                    std::span<const std::string> names,
                                                    std::span<const size_t> lines,
                                                    const std::string& file);

}  // namespace vpr
