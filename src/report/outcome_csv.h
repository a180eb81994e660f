// Single queries and recognitions as tidy CSV: one row each, one header, for data frames.
#pragma once

#include <string>

namespace vpr {

struct Judgement;
struct JudgedResult;

/// Header lines, with their line feeds.
std::string outcomes_csv_header();
std::string recognitions_csv_header();

/// One row a query window (a frame): where it ends, its best match, and how right it is. `name` and
/// `query` stand in front of each row. A field that is not known is empty.
std::string outcomes_csv(const Judgement& judgement, const std::string& name,
                         const std::string& query);

/// One row a cluster of hits: the frames that its windows cover, and the frames at which it is
/// judged. Of a result without clusters one row a hit: a frame and a place, whose index the "train"
/// columns hold.
std::string recognitions_csv(const JudgedResult& judged, const std::string& name);

}  // namespace vpr
