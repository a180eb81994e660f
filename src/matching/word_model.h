// Which of FAB-MAP's models are used: apart, for settings name them without what they compute.
#pragma once

#include <array>
#include <string_view>

#include "base/enum_names.h"

namespace vpr {

/// Whether a word depends on its parent in the Chow-Liu tree, or on no other one.
enum class WordModel { tree, naive_bayes };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<WordModel> = {"tree", "naive-bayes"};

/// How likely an unknown place is: by the probabilities of its words, or on average over
/// pretraining frames.
enum class NewPlaceModel { mean_field, pretrain };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<NewPlaceModel> = {"mean-field",
                                                                              "pretrain"};

}  // namespace vpr
