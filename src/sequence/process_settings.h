// Settings that belong to the whole process: of every program and of every call from Python.
#pragma once

#include <cstdint>

#include "base/json_fwd.h"
#include "base/parallel.h"
#include "sequence/decode.h"
#include "sequence/sequence_source.h"

namespace vpr {

struct ProcessSettings {
  uint64_t threads = 0;  ///< 0: all cores
  uint64_t seed = 1;
  uint64_t max_megapixels = kDefaultMegapixels;
  FrameOrder order = FrameOrder::automatic;
};
VPR_FIELDS(ProcessSettings, threads, seed, max_megapixels, order)

/// Applies settings to the process during its lifetime, and has OpenCV work on one thread per
/// frame, silently, without code that depends on the processor. Throws Error(usage) for settings
/// out of range.
struct ProcessScope {
  explicit ProcessScope(const ProcessSettings& settings);
  ~ProcessScope();
  ProcessScope(const ProcessScope&) = delete;
  ProcessScope& operator=(const ProcessScope&) = delete;

  ThreadLimit threads;
  MegapixelLimit pixels;
  FrameOrderScope order;
  int cv_threads;
  bool is_cv_optimized;
  int cv_log_level;
};

}  // namespace vpr
