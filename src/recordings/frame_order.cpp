#include "recordings/frame_order.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "base/error.h"
#include "base/text.h"

namespace vpr {

namespace {

namespace fs = std::filesystem;

std::atomic<FrameOrder> frame_order{FrameOrder::automatic};
std::atomic<bool> frame_order_is_used{false};

/// The last number in a file name: "left_3082.08 b.jpg" is "left_", 3082.08 and " b".
struct NumberedName {
  std::string_view prefix;
  std::optional<double> value;  // nullopt: there is no number
  std::string_view suffix;      // without the extension
  std::string_view fraction;    // the digits after its point
  bool is_decimal = false;
};

NumberedName numbered(std::string_view name) {
  constexpr std::string_view kDigits = "0123456789";
  const std::string_view stem = name.substr(0, name.rfind('.'));
  const size_t end = stem.find_last_of(kDigits) + 1;  // npos + 1 is 0
  const auto begin_of = [&](size_t last) {
    const size_t other = stem.substr(0, last).find_last_not_of("0123456789.");
    return std::min(stem.find_first_of(kDigits, other + 1), last);
  };
  size_t begin = begin_of(end);
  // The exponent of 1e-05, and a sign.
  if (begin > 2 && kDigits.find(stem[begin - 3]) != std::string_view::npos &&
      (stem.substr(begin - 2, 2) == "e-" || stem.substr(begin - 2, 2) == "e+"))
    begin = begin_of(begin - 2);
  if (begin == 1 && stem.front() == '-') begin = 0;
  const std::string_view number = stem.substr(begin, end - begin);
  const std::string_view mantissa = number.substr(0, number.find('e'));
  const size_t point = std::min(mantissa.find('.'), mantissa.size());
  return {stem.substr(0, begin), parse_number<double>(number), stem.substr(end),
          mantissa.substr(std::min(point + 1, mantissa.size())),
          number.find_first_of(".e") != std::string_view::npos};
}

// By prefix, then by value.
bool decimal_less(std::string_view a, std::string_view b) {
  const NumberedName x = numbered(a);
  const NumberedName y = numbered(b);
  if (x.prefix != y.prefix) return natural_less(x.prefix, y.prefix);
  return x.value != y.value ? x.value < y.value : natural_less(a, b);
}

bool time_less(std::string_view a, std::string_view b) {
  const auto x = numbered(a).value;
  const auto y = numbered(b).value;
  return x != y ? x < y : natural_less(a, b);
}

// The order of names in natural order, some of which are decimal numbers.
NameOrder order_of_decimals(const std::vector<std::string>& names, const fs::path& folder) {
  std::set<std::string_view> prefixes;  // of decimal numbers
  for (const std::string& name : names)
    if (const NumberedName parts = numbered(name); parts.value && parts.is_decimal)
      prefixes.insert(parts.prefix);
  std::map<std::string_view, double> last;  // number with each prefix
  std::set<std::tuple<std::string_view, double, std::string_view>> different;
  bool do_agree = true;                 // the natural order and the order by value
  size_t numbers = 0;                   // with these prefixes, also integers
  std::set<size_t> lengths;             // of their fractions
  const std::string* other = nullptr;   // another name
  const std::string* padded = nullptr;  // a fraction that ends in 0
  bool begins_with_0 = false;           // a fraction of several digits
  for (const std::string& name : names) {
    const NumberedName parts = numbered(name);
    if (!parts.value || !prefixes.contains(parts.prefix)) {
      other = &name;
      continue;
    }
    ++numbers;
    different.insert({parts.prefix, *parts.value, parts.suffix});
    const auto [before, is_first] = last.try_emplace(parts.prefix, *parts.value);
    do_agree = do_agree && (is_first || before->second <= *parts.value);
    before->second = *parts.value;
    if (!parts.is_decimal) continue;
    lengths.insert(parts.fraction.size());
    begins_with_0 = begins_with_0 || (parts.fraction.size() > 1 && parts.fraction.starts_with('0'));
    if (parts.fraction.size() > 1 && parts.fraction.ends_with('0')) padded = &name;
  }
  if (do_agree) return nullptr;
  constexpr const char* kAdvice =
      "Rename it, or pass --order natural (1.2 before 1.10) or --order time (by value)";
  if (other != nullptr && 2 * numbers > names.size())
    throw Error(ErrorKind::usage,
                "{}: most names are decimal numbers, but not {}, so the order of frames is "
                "unclear. {}",
                folder.string(), *other, kAdvice);
  if (other != nullptr || different.size() < numbers) return natural_less;
  if (padded != nullptr && lengths.size() > 1)
    throw Error(ErrorKind::usage,
                "{}: digits after the point may count, because {} ends in 0 and others are shorter "
                "or longer, so the order of frames is unclear. {}",
                folder.string(), *padded, kAdvice);
  constexpr size_t kNanoseconds = 9;
  if (lengths.size() > 1 && *lengths.rbegin() == kNanoseconds && !begins_with_0)
    throw Error(ErrorKind::usage,
                "{}: the digits after the point may be nanoseconds without leading zeros, because "
                "there are {} to 9 of them, so the order of frames is unclear. {}",
                folder.string(), *lengths.begin(), kAdvice);
  return decimal_less;
}

}  // namespace

FrameOrder set_frame_order(FrameOrder order) {
  frame_order_is_used = false;
  return frame_order.exchange(order);
}

FrameOrder current_frame_order() { return frame_order; }

bool is_frame_order_used() { return frame_order_is_used; }

NameOrder name_order(std::vector<std::string> names, const fs::path& folder) {
  const NameOrder by_bytes = [](std::string_view a, std::string_view b) { return a < b; };
  const auto is_utm = [](const std::string& name) { return std::ranges::count(name, '@') > 1; };
  const FrameOrder wanted = frame_order;
  frame_order_is_used = true;
  if (wanted == FrameOrder::name) return by_bytes;
  if (wanted == FrameOrder::natural) return natural_less;
  if (wanted == FrameOrder::time) {
    for (const std::string& name : names)
      if (!numbered(name).value)
        throw Error(ErrorKind::usage, "{}: the name {} is not a number, which --order time needs",
                    folder.string(), name);
    return time_less;
  }
  if (!names.empty() && std::ranges::all_of(names, is_utm))
    return wanted == FrameOrder::rows ? by_bytes : natural_less;
  if (std::ranges::none_of(names, &NumberedName::is_decimal, numbered)) return nullptr;
  std::ranges::sort(names, natural_less);
  return order_of_decimals(names, folder);
}

}  // namespace vpr
