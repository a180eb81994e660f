#include "score_flags.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"

namespace vpr {

void add_score_flags(const Command& command, ScoreFlags& flags, const std::string& help,
                     const std::string& group) {
  command.add_option("--scores", flags.path, help).group(group).type_name("FILE");
  const Flag distance =
      command.add_flag("--distance", flags.is_distance, "small scores are good").group(group);
  command.add_flag("--similarity", flags.is_similarity, "large scores are good")
      .group(group)
      .excludes(distance);
  command
      .add_flag("--references-first", flags.references_first,
                "rows of the matrix are references, columns are queries")
      .group(group);
  add_setting(command, "--missing", flags.missing,
              "value that stands for a missing score, as NaN does")
      .group(group);
}

void require_order(const ScoreFlags& flags) {
  if (!flags.has_order())
    throw Error(ErrorKind::usage,
                "say what the scores are: --distance (small is good) or --similarity (large is)");
}

void refuse(bool is_given, const std::string& flag, const std::string& why) {
  if (is_given) throw Error(ErrorKind::usage, fmt::format("{} {}", flag, why));
}

void refuse_format(const ScoreFlags& flags, const std::string& why) {
  refuse(flags.is_distance, "--distance", why);
  refuse(flags.is_similarity, "--similarity", why);
  refuse(flags.references_first, "--references-first", why);
  refuse(flags.missing.has_value(), "--missing", why);
}

}  // namespace vpr
