// The order of the frames in a folder, by their names.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"

namespace vpr {

/// The order of the files in folders. `automatic`: by the number in each name, after its prefix, if
/// some of them are decimal, none are equal, and every name has one; otherwise natural. `name`: as
/// bytes. `time`: by the number alone, which every name must have. `rows`: as automatic, but UTM
/// names (with two or more @) as bytes, as the programs that write rows for such names read them.
enum class FrameOrder { automatic, natural, name, time, rows };
template <>
inline constexpr std::array<std::string_view, 5> kEnumNames<FrameOrder> = {"auto", "natural",
                                                                           "name", "time", "rows"};

/// Sets the order in the whole process; returns the last one.
FrameOrder set_frame_order(FrameOrder order);
FrameOrder current_frame_order();
/// Whether a folder was read since then.
bool is_frame_order_used();

/// Whether a name is before another one; a strict order of all names.
using NameOrder = bool (*)(std::string_view, std::string_view);

/// The order of these files of a folder, as set_frame_order says. Null: natural_less, which on
/// these names is also the order by value. Throws Error(usage) if it is unclear.
NameOrder name_order(std::vector<std::string> names, const std::filesystem::path& folder);

}  // namespace vpr
