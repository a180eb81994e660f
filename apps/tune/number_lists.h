// Lists and ranges of numbers on a command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace vpr {

/// "2,5,10", "0.2:0.6:0.05" (both ends included where the steps meet them), "1:5" (in steps of 1),
/// or a mixture; repeated values count once. Values of a range are rounded to nine decimals, so
/// that 0.3 is 0.3. Throws Error(usage), naming the flag.
std::vector<double> parse_numbers(const std::string& text, const std::string& flag);

/// The same, and the word "auto" among them, which is none: an automatic threshold. In the order in
/// which they are given.
std::vector<std::optional<double>> parse_thresholds(const std::string& text,
                                                    const std::string& flag);

/// The same for whole numbers from 1 on.
std::vector<uint64_t> parse_counts(const std::string& text, const std::string& flag);

}  // namespace vpr
