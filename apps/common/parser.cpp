#include "parser.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "progress.h"
#include "query/result_file.h"

namespace vpr {

namespace {

// "text|csv" is a choice; "NUMBER" is not.
std::vector<std::string> split_choices(const std::string& value) {
  const auto choices = split(value, '|');
  if (choices.size() < 2) return {};
  return {choices.begin(), choices.end()};
}

/// The words for values that are strings, by the flags of all programs.
struct ValueWord {
  std::string_view word;
  std::string_view flags;  // each between blanks
};
constexpr std::array<ValueWord, 7> kValueWords = {
    {{"SEQUENCE", " --query --train --pretrain --validate --images "},
     {"FILE",
      " --dataset --names --vocabulary --tree --save-config --save-posteriors --heat-map --result "
      "--ground-truth --validate-ground-truth --marked-places "},
     {"FOLDER", " --train-folders --plot --fabmap "},
     {"PATH", " --output "},
     {"NAME", " --name --only-sequence --place --sequence --same-place --descriptor "},
     {"FORMAT", " --to "},
     {"LIST", " --c-l --c-w --t-r --t-p --margin "}}};

std::string value_word(const std::string& word, const std::string& flag) {
  if (word == "NUMBERS" || word == "NAMES") return "LIST";
  if (word != "TEXT" && word != "VALUE") return word;
  for (const ValueWord& row : kValueWords)
    if (row.flags.find(fmt::format(" {} ", flag)) != std::string_view::npos)
      return std::string(row.word);
  return word;
}

FlagEntry describe_flag(const CLI::Option& option) {
  FlagEntry flag;
  for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
  if (!option.nonpositional()) flag.names = {option.get_name(true)};
  if (option.get_items_expected_max() > 0) {
    const std::string type = option.get_type_name();  // "WORD:choices"
    const size_t colon = type.find(':');
    flag.value = value_word(type.substr(0, colon), flag.names.back());
    flag.choices = split_choices(colon == std::string::npos ? flag.value : type.substr(colon + 1));
  }
  flag.help = option.get_description();
  flag.group = option.get_group();
  flag.is_required = option.get_required();
  return flag;
}

// Sorts by group, in the order of their first flags; the common group is last. Required flags are
// first in their group, and the output is last.
void sort_flags(std::vector<FlagEntry>& flags) {
  std::vector<std::string> groups;
  for (const FlagEntry& flag : flags)
    if (flag.group != kCommonGroup && std::ranges::count(groups, flag.group) == 0)
      groups.push_back(flag.group);
  const auto rank = [&](const FlagEntry& flag) {
    const auto group = std::find(groups.begin(), groups.end(), flag.group) - groups.begin();
    return std::tuple(group, !flag.is_required, flag.names.front() == "-o");
  };
  std::stable_sort(flags.begin(), flags.end(),
                   [&](const FlagEntry& a, const FlagEntry& b) { return rank(a) < rank(b); });
}

CommandEntry describe_commands(const CLI::App& app) {
  CommandEntry entry;
  entry.name = app.get_name();
  entry.aliases = app.get_aliases();
  entry.description = app.get_description();
  entry.sections = split_sections(app.get_footer());
  entry.runs_itself = app.get_require_subcommand_min() == 0;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->nonpositional() ? entry.flags : entry.arguments).push_back(describe_flag(*option));
  }
  sort_flags(entry.flags);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    entry.commands.push_back(describe_commands(*command));
  return entry;
}

class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    const CLI::App* parent = app->get_parent();
    if (parent != nullptr && !name.starts_with(parent->get_name() + " "))
      name = parent->get_name() + " " + app->get_name();
    const CommandEntry command = describe_commands(*app);
    return mode == CLI::AppFormatMode::All ? help_text(command, name)
                                           : short_help_text(command, name);
  }
};

void group_own_flags(CLI::App& app, const std::string& version) {
  app.set_version_flag("-V,--version", version, "print the version and exit");
  app.get_version_ptr()->group(kCommonGroup);
  app.set_help_flag("-h", "print the essential options and exit")->group(kCommonGroup);
  app.set_help_all_flag("--help", "print all options and exit")->group(kCommonGroup);
}

void add_given(const CLI::App& app, std::vector<GivenFlag>& given) {
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0) given.push_back({option->get_lnames(), option->results()});
  for (const CLI::App* command : app.get_subcommands()) add_given(*command, given);
}

// "; did you mean --c-l?" if a known word starts with `word` or is a typo away, otherwise ".".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const auto longer = std::ranges::find_if(known, [&](const std::string& name) {
    return name.size() > word.size() && name.starts_with(word);
  });
  const std::string best = longer == known.end() ? nearest(word, known) : *longer;
  const size_t most_edits = std::clamp<size_t>((word.size() - 1) / 3, 1, 2);
  const bool is_near = longer != known.end() || edit_distance(word, best) <= most_edits;
  return is_near ? fmt::format("; did you mean {}?", best) : ".";
}

void add_flags(const CommandEntry& command, std::vector<std::string>& known) {
  for (const FlagEntry& flag : command.flags)
    known.insert(known.end(), flag.names.begin(), flag.names.end());
}

// "; use --train", for a flag of another command, or an old name, with its counterpart in this one;
// empty without.
std::string counterpart(const std::string& flag, const std::vector<std::string>& known) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kCounterparts = {
      {{"--npy", "--train"},
       {"--npy", "--query"},
       {"--query-npy", "--query"},
       {"--train-npy", "--train"},
       {"--query-bow", "--query"},
       {"--csv", "--format csv"},
       {"--latex", "--format latex"},
       {"--markdown", "--format markdown"},
       {"--out", "--output"},
       {"--gt", "--ground-truth"},
       {"--places", "--place-counts"},
       {"--frames", "--query-frames"}}};
  for (const auto& [other, own] : kCounterparts)
    if (flag == other && std::ranges::count(known, own.substr(0, own.find(' '))) > 0)
      return fmt::format("; use {}.", own);
  return "";
}

// A message about the number of values, in the words of other errors.
std::string in_our_words(const std::string& error) {
  const size_t colon = error.find(": ");
  const std::string name = error.substr(0, colon);
  if (colon != std::string::npos && error.ends_with(" missing"))
    return fmt::format("{} needs a value", name);
  const size_t fewest = error.find("At least ");
  const size_t received = error.find(" required but received ");
  if (fewest == std::string::npos || received == std::string::npos) return error;
  return fmt::format("{} needs {} or more, found {}", name,
                     error.substr(fewest + 9, received - fewest - 9), error.substr(received + 23));
}

// Describes the first unknown flag, or the unknown or missing command, with the nearest known name
// and the help to read; nullopt if all words are known. `words`: the command line without the
// program.
std::optional<std::string> unknown_word(const CommandEntry& program,
                                        const std::vector<std::string>& words) {
  std::vector<std::string> flags;
  add_flags(program, flags);
  std::vector<std::string> commands;
  for (const CommandEntry& command : program.commands) commands.push_back(command.name);
  std::string path = program.name;
  for (const std::string& word : words) {
    const auto named = std::ranges::find_if(program.commands, [&](const CommandEntry& command) {
      return command.name == word || std::ranges::count(command.aliases, word) > 0;
    });
    if (named != program.commands.end() && path == program.name) {
      add_flags(*named, flags);
      path += " " + word;
    } else if (&word == &words.front() && !program.runs_itself && !word.starts_with('-')) {
      return fmt::format("unknown command {}{} There are {}", shell_word(word),
                         did_you_mean(word, commands), fmt::join(commands, ", "));
    }
  }
  if (path == program.name && !program.runs_itself)
    return fmt::format("a command is missing: {}; see {} --help", fmt::join(commands, ", "), path);
  for (const std::string& word : words) {
    if (word == "--") break;
    const std::string name = word.substr(0, word.find('='));
    const bool is_flag = name.size() > 2 && name.starts_with("--");
    if (!is_flag || std::ranges::count(flags, name) > 0) continue;
    const std::string own = counterpart(name, flags);
    return fmt::format("unknown flag {}{} See {} --help", name,
                       own.empty() ? did_you_mean(name, flags) : own, path);
  }
  return std::nullopt;
}

}  // namespace

Flag Flag::required() {
  option_->required();
  return *this;
}

Flag Flag::group(const std::string& heading) {
  option_->group(heading);
  return *this;
}

Flag Flag::choices(const std::string& word, const std::vector<std::string>& names) {
  option_->type_name(fmt::format("{}:{}", word, fmt::join(names, "|")));
  return *this;
}

Flag Flag::read_first() {
  option_->trigger_on_parse();
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

template <class T>
Flag Command::add_option(const std::string& flag, T& value, const std::string& help,
                         const std::string& group, const std::string& word) const {
  CLI::Option& option = *app_->add_option(flag, value, help)->group(group);
  const bool is_number =
      std::is_same_v<T, std::optional<uint64_t>> || std::is_same_v<T, std::optional<double>>;
  if (is_number || !word.empty()) option.type_name(word.empty() ? "NUMBER" : word);
  return Flag(option);
}

using Text = const std::string;
template Flag Command::add_option(Text&, std::string&, Text&, Text&, Text&) const;
template Flag Command::add_option(Text&, std::optional<std::string>&, Text&, Text&, Text&) const;
template Flag Command::add_option(Text&, std::optional<uint64_t>&, Text&, Text&, Text&) const;
template Flag Command::add_option(Text&, std::optional<double>&, Text&, Text&, Text&) const;
template Flag Command::add_option(Text&, std::vector<std::string>&, Text&, Text&, Text&) const;
template Flag Command::add_option(Text&, std::vector<uint64_t>&, Text&, Text&, Text&) const;

Flag Command::add_option(const std::string& flag,
                         const std::function<void(const std::string&)>& read,
                         const std::string& help, const std::string& group,
                         const std::string& word) const {
  CLI::Option& option = *app_->add_option_function<std::string>(flag, read, help)->group(group);
  if (!word.empty()) option.type_name(word);
  return Flag(option);
}

Flag Command::add_flag(const std::string& flag, bool& value, const std::string& help,
                       const std::string& group) const {
  return Flag(*app_->add_flag(flag, value, help)->group(group));
}

Flag Command::add_list(const std::string& flag, std::vector<std::string>& values,
                       const std::string& help, const std::string& group,
                       const std::string& word) const {
  return Flag(*app_->add_option(flag, values, help)
                   ->group(group)
                   ->expected(1)
                   ->take_all()
                   ->allow_extra_args(false)
                   ->type_name(word));
}

void Command::add_alias(const std::string& name) const { app_->alias(name); }

void Command::remove_flag(const std::string& flag) const {
  app_->remove_option(app_->get_option(flag));
}

void Command::add_footer(const std::string& text) const {
  app_->footer(text + "\n" + app_->get_footer());
}

bool Command::is_given(const std::string& flag) const {
  const CLI::Option* option = app_->get_option_no_throw(flag);
  return option != nullptr && option->count() > 0;
}

std::vector<std::string> Command::values_of(const std::string& flag) const {
  const CLI::Option* option = app_->get_option_no_throw(flag);
  return option == nullptr ? std::vector<std::string>{} : option->results();
}

std::vector<std::string> Command::given_flags(const std::string& heading) const {
  std::vector<std::string> names;
  for (const CLI::Option* option : app_->get_options())
    if (option->get_group() == heading && option->count() > 0) names.push_back(option->get_name());
  return names;
}

Parser::Parser(const std::string& name, const std::string& description, const std::string& version)
    : version_(version), app_(std::make_unique<CLI::App>(description, name)) {
  app_->formatter(std::make_shared<HelpFormatter>());
  group_own_flags(*app_, version_);
}

Parser::~Parser() = default;

Command Parser::root() const { return Command(*app_); }

Command Parser::add_command(const std::string& name, const std::string& description,
                            std::function<void(const Command&)> chosen) {
  CLI::App& app = *app_->add_subcommand(name, description);
  app.footer("");  // do not inherit the program's
  group_own_flags(app, version_);
  app.callback([&app, chosen = std::move(chosen)] { chosen(Command(app)); });
  return Command(app);
}

void Parser::require_command(bool required) { app_->require_subcommand(required ? 1 : 0, 1); }

bool Parser::parse(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "help" && !std::filesystem::exists("help")) {
    words.erase(words.begin());
    words.emplace_back("-h");
  }
  try {
    app_->parse(std::vector(words.rbegin(), words.rend()));
    return true;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // -h, --help, --version
      std::ostringstream text;
      app_->exit(error, text, text);
      write_to_stdout(text.str());
      return false;
    }
    const std::vector<std::string> extra = app_->remaining(true);
    if (!extra.empty() && extra.front().empty())
      throw Error(ErrorKind::usage, "an argument is empty. Is a variable of the shell unset?");
    if (const auto unknown = unknown_word(describe(), words))
      throw Error(ErrorKind::usage, *unknown);
    std::string path = app_->get_name();
    for (const CLI::App* command : app_->get_subcommands()) path += " " + command->get_name();
    if (!extra.empty() && extra.front().starts_with('-')) {
      // Of -version, -v is a flag and -ersion remains.
      const auto typed = std::ranges::find_if(words, [&](const std::string& word) {
        return word.starts_with('-') && word.ends_with(extra.front().substr(1));
      });
      throw Error(ErrorKind::usage, "unknown flag {}. See {} --help",
                  typed == words.end() ? extra.front() : *typed, path);
    }
    for (const char* flag : {"--query", "--train"})
      if (!extra.empty() && takes(flag))
        throw Error(ErrorKind::usage, "unexpected argument {}; did you mean {} {}?", extra.front(),
                    flag, extra.front());
    throw Error(ErrorKind::usage, "{}; see {} --help", in_our_words(error.what()), path);
  }
}

std::vector<GivenFlag> Parser::given() const {
  std::vector<GivenFlag> given;
  add_given(*app_, given);
  return given;
}

bool Parser::takes(const std::string& flag) const {
  const auto commands = app_->get_subcommands();
  return (commands.empty() ? *app_ : *commands.front()).get_option_no_throw(flag) != nullptr;
}

CommandEntry Parser::describe() const { return describe_commands(*app_); }

Json flag_value(const std::string& text) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto parse = [&](auto value) -> std::optional<Json> {
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc{} || stop != end) return std::nullopt;
    return Json(value);
  };
  if (const auto integer = parse(uint64_t{})) return *integer;
  if (const auto negative = parse(int64_t{})) return *negative;
  if (const auto real = parse(double{}); real && std::isfinite(real->get<double>())) return *real;
  return text;
}

Json read_config(const std::string& path) {
  Json json = read_json(path, ErrorKind::usage);
  if (!json.is_object() || !json.contains("schema")) return json;
  const Json& schema = json["schema"];
  if (schema.is_string() && schema.get_ref<const std::string&>().starts_with("vpr.result/")) {
    const Json result = read_result_json(path);
    Json settings = result.value("settings", Json::object());
    const Json provenance = result.value("provenance", Json::object());
    if (settings.is_object() && provenance.is_object() && provenance.contains("seed"))
      settings["seed"] = provenance["seed"];
    return settings;
  }
  if (schema == schema_name("sweep"))
    throw Error(ErrorKind::usage,
                "{}: is a sweep over many settings. Save the recommended settings with vpr-tune "
                "--save-config FILE and use that file.",
                path);
  if (schema == schema_name("tuning")) {
    if (json.contains("settings") && json["settings"].is_object()) return json["settings"];
    throw Error(ErrorKind::usage, "{}: chooses no setting.", path);
  }
  require_schema(json, "config", path, ErrorKind::usage);
  json.erase("schema");
  return json;
}

std::vector<Section> split_sections(const std::string& footer) {
  std::vector<Section> sections;
  bool is_start = true;
  for (const std::string_view line : split_lines(footer)) {
    if (is_start && line.ends_with(':') && !line.starts_with(' '))
      sections.push_back({std::string(line.substr(0, line.size() - 1)), ""});
    else if (!sections.empty())
      sections.back().text += std::string(line) + "\n";
    is_start = line.empty();
  }
  for (Section& section : sections) section.text.erase(section.text.find_last_not_of('\n') + 1);
  return sections;
}

}  // namespace vpr
