// Results of FAB-MAP queries: RESULT.json with .hits.npy, .hit_scores.npy, .best.npy,
// .best_scores.npy and .new_place.npy beside it.
#pragma once

#include <filesystem>
#include <string>

#include "base/json_fwd.h"
#include "recognition/fabmap_result.h"
#include "report/result_file.h"

namespace vpr {

/// Claims the result and its companions.
void claim_fabmap_result(const std::filesystem::path& path, OutputTransaction& outputs);

Json fabmap_result_json(const FabmapResult& result, const ResultContext& context);

/// Writes the companions and the JSON, which it returns; the caller commits.
Json write_fabmap_result(const std::filesystem::path& path, const FabmapResult& result,
                         const ResultContext& context, OutputTransaction& outputs);

struct StoredFabmapResult {
  FabmapResult result;
  std::string fingerprint;
};

/// Throws as read_result does.
StoredFabmapResult read_fabmap_result(const std::filesystem::path& path);

}  // namespace vpr
