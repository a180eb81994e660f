// The call of vpr-eval compare, in a library of its own: vpr/vpr.h does not need its tables.
#pragma once

#include <string>
#include <vector>

#include "present/comparison_report.h"
#include "vpr/calls.h"

namespace vpr::calls {

/// As vpr-eval compare. `texts`: at least two report files, which `names` name. Throws Error(data)
/// for ground truths that differ, unless the settings allow it.
std::vector<ComparisonReport> compare(Keywords& keywords, const std::vector<std::string>& texts,
                                      const std::vector<std::string>& names,
                                      const Monitor& monitor);

}  // namespace vpr::calls
