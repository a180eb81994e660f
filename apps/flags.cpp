#include "flags.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace vpr {

Flag Flag::required() {
  option_->required();
  return *this;
}

Flag Flag::group(const std::string& heading) {
  option_->group(heading);
  return *this;
}

Flag Flag::type_name(const std::string& word) {
  option_->type_name(word);
  return *this;
}

Flag Flag::choices(const std::string& word, const std::vector<std::string>& names) {
  return type_name(fmt::format("{}:{}", word, fmt::join(names, "|")));
}

Flag Flag::non_negative() {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}

Flag Flag::excludes(const Flag& other) {
  option_->excludes(other.option_);
  return *this;
}

Flag Flag::expected(int fewest, int most) {
  option_->expected(fewest, most);
  return *this;
}

Flag Flag::comma_separated() {
  option_->delimiter(',')->allow_extra_args(false);
  return *this;
}

Flag Command::add_option(const std::string& flag, std::string& value,
                         const std::string& help) const {
  return Flag(*app_->add_option(flag, value, help));
}

Flag Command::add_option(const std::string& flag, std::optional<std::string>& value,
                         const std::string& help) const {
  return Flag(*app_->add_option(flag, value, help));
}

Flag Command::add_option(const std::string& flag, std::vector<std::string>& values,
                         const std::string& help) const {
  return Flag(*app_->add_option(flag, values, help));
}

Flag Command::add_option(const std::string& flag, std::vector<uint64_t>& values,
                         const std::string& help) const {
  return Flag(*app_->add_option(flag, values, help));
}

Flag Command::add_option(const std::string& flag, std::optional<uint64_t>& value,
                         const std::string& help) const {
  return Flag(*app_->add_option(flag, value, help));
}

Flag Command::add_option(const std::string& flag, std::optional<double>& value,
                         const std::string& help) const {
  return Flag(*app_->add_option(flag, value, help));
}

Flag Command::add_option(const std::string& flag, std::function<void(const std::string&)> read,
                         const std::string& help) const {
  return Flag(*app_->add_option_function<std::string>(flag, read, help));
}

Flag Command::add_flag(const std::string& flag, bool& value, const std::string& help) const {
  return Flag(*app_->add_flag(flag, value, help));
}

Flag Command::add_list(const std::string& flag, std::vector<std::string>& values,
                       const std::string& help) const {
  return Flag(*app_->add_option(flag, values, help)
                   ->expected(1)
                   ->take_all()
                   ->allow_extra_args(false)
                   ->type_name("TEXT"));
}

void Command::add_footer(const std::string& text) const {
  app_->footer(text + "\n" + app_->get_footer());
}

bool Command::is_given(const std::string& flag) const { return app_->count(flag) > 0; }

std::vector<std::string> Command::given_flags(const std::string& heading) const {
  std::vector<std::string> names;
  for (const CLI::Option* option : app_->get_options())
    if (option->get_group() == heading && option->count() > 0) names.push_back(option->get_name());
  return names;
}

}  // namespace vpr
