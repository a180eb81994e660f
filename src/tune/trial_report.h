// Trials of different settings (vpr.tuning/4) as JSON, table and text.
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "files/run_info.h"
#include "present/table.h"
#include "tune/trials.h"

namespace vpr {

/// "settings": those of the choice, a configuration for vpr-query --config, or null.
Json trials_json(const Trials& trials, const RunInfo& run, double seconds);

/// A row per setting, or per setting and query: frames recognized correctly and incorrectly, the
/// first correctly recognized frame, and the time per frame.
Table trials_table(const Trials& trials, bool by_query);

/// The choice and the number of frames that it rests on, or the reason why there is none. `advice`:
/// filter_advice of a query without a recognized frame; empty if frames are recognized. Ends with a
/// line feed.
std::string choice_text(const Trials& trials, const std::string& advice);

}  // namespace vpr
