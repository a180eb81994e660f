// Rates of training sequences in database folders, and which frames of their recordings they are.
#pragma once

#include <vector>

#include "base/json_fwd.h"
#include "database/archive.h"
#include "database/sequence_database.h"

namespace vpr {

/// Adds "fps" and "thinned" to the entry of a sequence, where it has them.
void add_rate(Json& json, const TrainSequence& sequence);

/// Writes kept.npy: of the sequences that are thinned, one after the other, by frame the frame of
/// the recording that it is; no file where none is.
void write_kept(ArchiveWriter& writer, const std::vector<TrainSequence>& sequences);

/// Reads both, and the frames of kept.npy, into the sequences of the manifest. Throws Error(data)
/// through `archive` for what is out of range or order.
void read_rates(const Archive& archive, std::vector<TrainSequence>& sequences);

}  // namespace vpr
