// Expected values as JUnit XML, which CI systems show.
#pragma once

#include <span>
#include <string>

#include "evaluation/expectation.h"

namespace vpr {

/// One test suite with a test case for each value; those that are not met have a failure that says
/// what was expected and found. `suite`: what is tested, `file`: what expects it. Whatever the
/// texts hold, the file is well-formed XML 1.0.
std::string junit_xml(const std::string& suite, const std::string& file,
                      std::span<const CheckedValue> values);

}  // namespace vpr
