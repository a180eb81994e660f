// What a MAT-file of version 5 consists of, looked at before the library that reads it is called.
#pragma once

#include <string_view>

#include "ground_truth/builder.h"

namespace vpr {

/// Throws Error(data) for a MAT-file (all of its bytes) that is not of version 5 to 7.3, that is
/// cut off, or of which a matrix, compressed or not, has a part that is longer than itself: the
/// library makes room for what parts claim before it looks whether they are there, and fills up
/// what a file lacks with zeros. Of version 7.3 nothing else is looked at.
void require_whole_elements(const GroundTruthBuilder& builder, std::string_view bytes);

/// Whether it says that it is one of version 5 to 7.3.
bool begins_as_mat_file(std::string_view bytes);

}  // namespace vpr
