#include "query/setting_rows.h"

#include <algorithm>

namespace vpr {
namespace {

constexpr uint32_t kQuery = in(QueryCommand::query);
constexpr uint32_t kOnline = in(QueryCommand::live, QueryCommand::loops);

constexpr std::array kSequenceRows = {
    SettingRow{.key = "c_l",
               .commands = kQuery | kOnline,
               .help = "window length c_l in frames, selects FastABLE (default: {})",
               .is_for_windows = true,
               .instead = "Omit it, or use --method fastable."},
    SettingRow{.key = "t_r",
               .commands = kQuery | kOnline,
               .help =
                   "threshold t_r of windows, selects FastABLE; a number, or auto, the smallest "
                   "distance between two or more training sequences of a database",
               .is_for_windows = true,
               .instead = "Use --margin, or --method fastable with --decide threshold."},
    SettingRow{.key = "score",
               .group = kWindowGroup,
               .commands = kQuery | kOnline | in(QueryCommand::sweep),
               .help =
                   "score of windows: raw (distances) or zscore (normalized online per training "
                   "frame) (default: {})",
               .is_for_windows = true,
               .instead = "Omit it, or use --method fastable."},
    SettingRow{
        .key = "exclusion_frames",
        .group = kWindowGroup,
        .commands = kQuery | kOnline | in(QueryCommand::sweep),
        .help = "exclusion zone: frames before and after the best match (default: the "
                "frames after which training sequences show another place)",
        .is_for_windows = true,
        .instead =
            "Use --method fastable, or for the filter, filter.near_keyframes in a configuration."},
    SettingRow{.key = "decide",
               .group = kWindowGroup,
               .commands = kQuery | kOnline | in(QueryCommand::sweep),
               .help =
                   "decision on windows: threshold accepts every pair closer than --t-r, margin "
                   "the best match if it is --margin better than the runner-up (default: {})",
               .is_for_windows = true,
               .instead = "Use --method fastable."},
    SettingRow{.key = "t_r_scale",
               .group = kWindowGroup,
               .commands = kQuery | in(QueryCommand::sweep),
               .help =
                   "scale of t_r: relative (D / max D), bits (D / c_l), or mean-z, which z-scores "
                   "always have (default: relative)",
               .is_for_windows = true,
               .instead = "Omit it."},
    SettingRow{.key = "t_r_scale",
               .group = kWindowGroup,
               .commands = kOnline,
               .help = "scale of t_r: bits (D / c_l), or mean-z, which z-scores always have",
               .value = "bits|mean-z",
               .is_for_windows = true},
    SettingRow{.key = "margin",
               .group = kWindowGroup,
               .commands = kQuery | kOnline,
               .help =
                   "minimum difference of best match and runner-up; for the filter in deviations "
                   "(default: 14), for z-score windows in deviations per frame (default: 5.1 / "
                   "sqrt(c_l)), for FastABLE in bits per frame (default: 0.75 / sqrt(c_l) of the "
                   "typical distance)",
               .instead = "Use --decide margin."},
    SettingRow{.key = "witness",
               .group = kWindowGroup,
               .commands = in(QueryCommand::query, QueryCommand::live),
               .help = "evidence that the filter adds to margins: orb, local features if the "
                       "database has them, or none (default: {})",
               .instead = "Omit it, or use --method filter."},
    SettingRow{.key = "same_place",
               .group = kWindowGroup,
               .commands = kQuery | in(QueryCommand::sweep),
               .help = "A=B: training sequences of the same place, which are in each other's "
                       "exclusion zone; repeatable; none: all differ (default: detected)",
               .instead = "Omit it."},
    SettingRow{.key = "only_sequence",
               .group = kWindowGroup,
               .commands = kQuery | in(QueryCommand::live),
               .help = "training sequence to search; repeatable (default: all)",
               .instead = "Omit it."},
    SettingRow{.key = "safety_factor",
               .group = kWindowGroup,
               .commands = in(QueryCommand::query),
               .help = "factor of the automatic t_r (default: the database's)",
               .is_for_windows = true,
               .instead = "Omit it."},
    SettingRow{.key = "skip_unreadable",
               .group = kQueryGroup,
               .commands = in(QueryCommand::query, QueryCommand::live, QueryCommand::loops,
                              QueryCommand::sweep),
               .help = "ignore frames that cannot be decoded; they keep their index and never "
                       "match"},
    SettingRow{.key = "descriptor",
               .group = kQueryGroup,
               .commands = in(QueryCommand::loops),
               .help = "descriptor of frames, as in vpr-train images (default: ldb; of arrays "
                       "vectors or bits)",
               .instead = "Use it with vpr-query loops and without a database."},
};

}  // namespace

std::string flag_of(std::string_view key) {
  std::string flag = "--" + std::string(key);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

std::span<const SettingRow> sequence_setting_rows() { return kSequenceRows; }

}  // namespace vpr
