// What sequences are called in results.
#pragma once

#include <string>
#include <vector>

#include "images/sequence_argument.h"

namespace vpr {

/// Names for results: the folder's (list's, video's) own name, with parents added ("a/ref",
/// "b/ref"), extensions or ranges where two are equal, or one is equal to a name that is taken.
/// Bytes that are not UTF-8 become %XX. Throws Error(usage) when that does not tell them apart: the
/// same frames were given twice.
std::vector<std::string> sequence_names(const std::vector<SequenceArgument>& arguments,
                                        const std::vector<std::string>& taken = {});

}  // namespace vpr
