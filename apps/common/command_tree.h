// A program's commands and flags as data, read from its parser: what help, completions and manual
// pages are written from, so that they can't get stale.
#pragma once

#include <string>
#include <vector>

namespace vpr {

/// Headings that stand apart: flags that all programs share come last.
inline constexpr const char* kCommonGroup = "Common options";
inline constexpr const char* kExampleSection = "Example";
inline constexpr const char* kExitCodeSection = "Exit codes";

struct FlagEntry {
  std::vector<std::string> names;    ///< with dashes, short ones first
  std::string value;                 ///< FILE, NUMBER, a|b|c; empty: takes none
  std::vector<std::string> choices;  ///< values that completions offer
  std::string help;
  std::string group;
  bool is_required = false;
};

struct ArgumentEntry {
  std::string name;
  std::string help;
  bool is_required = false;
};

/// A part of what help ends with: a heading, and lines as they stand.
struct Section {
  std::string title;
  std::string text;
};

struct CommandEntry {
  std::string name;
  std::string description;
  std::vector<Section> sections;
  std::vector<ArgumentEntry> arguments;
  std::vector<FlagEntry> flags;  ///< by group; within one, what is required first
  std::vector<CommandEntry> commands;
  bool runs_itself = true;  ///< false: one of its commands must be named
};

/// Headings end with a colon and stand behind an empty line, or first.
std::vector<Section> split_sections(const std::string& footer);

}  // namespace vpr
