// Small pictures of some frames of a sequence.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "images/selection.h"
#include "images/sequence.h"

namespace vpr {

/// A small picture of a frame.
struct Thumbnail {
  std::string name;             ///< the frame's file, or "#12" of a video
  std::vector<std::byte> jpeg;  ///< empty where the frame could not be read
};

/// At most `side` pixels a side, in colour. Of a folder or list only the wanted files are read, of
/// a video all frames. Frames that are not there are left out. Throws Error(input) as
/// for_each_frame does for a sequence without any readable frame.
std::map<size_t, Thumbnail> make_thumbnails(const Sequence& sequence,
                                            const std::set<size_t>& wanted, int side,
                                            const Monitor& monitor);

/// The same for frames of a replay of the sequence, or of itself where there is none.
std::map<size_t, Thumbnail> make_replay_thumbnails(const Sequence& sequence,
                                                   const std::optional<Replay>& replay,
                                                   const std::set<size_t>& wanted, int side,
                                                   const Monitor& monitor);

}  // namespace vpr
