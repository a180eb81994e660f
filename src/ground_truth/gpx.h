// Tracks of GPS receivers (GPX 1.0 and 1.1).
#pragma once

#include <filesystem>

#include "ground_truth/trajectory.h"

namespace vpr {

/// The track points of all tracks and segments, in the order of the file, on the earth
/// (earth_position(), heights left out), with their times where they have them; waypoints and
/// routes are not looked at, since nobody walked them. A range behind the path picks points. Times
/// may fall or repeat. Throws Error(input) if the file can't be read, Error(data), naming the line,
/// if it is no well-formed XML, has a document type (and with it entities, of which none is ever
/// loaded), has no track point, a latitude or longitude that is none, a time that is none, or times
/// of some points only.
Trajectory read_gpx(const std::filesystem::path& path);

/// Whether the content is XML with an element gpx near its start.
bool is_gpx(const FileStart& start);

}  // namespace vpr
