// vpr-query --explain: why a frame was taken for a place, as a picture.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/command.h"
#include "query_inputs.h"
#include "run/fabmap_query.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// The training sequences of --train-images by group: [GROUP=]SEQUENCE, in the order of groups of
/// that name. Throws Error(usage) for a name that the database does not have (so often).
std::map<size_t, SequenceArgument> images_by_group(const QueryInputs& inputs,
                                                   const FabmapDatabase& database);

/// A frame of the query as it was recorded.
struct FrameOfQuery {
  SequenceArgument sequence;
  size_t frame = 0;
};

/// The query's frame beside the views of its best places, with the words drawn in. Views have
/// images where --train-images names them, or where they are the query's own.
void write_explanation_picture(const Explanation& explanation, const QueryInputs& inputs,
                               const FrameOfQuery& query, const FabmapDatabase& searched,
                               bool searches_query, const Session& session);

/// RESULT.explain.png for RESULT.json.
std::filesystem::path explanation_picture_path(const std::string& output);

}  // namespace vpr
