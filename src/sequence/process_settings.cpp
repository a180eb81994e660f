#include "sequence/process_settings.h"

#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "base/error.h"

namespace vpr {
namespace {

size_t checked_threads(uint64_t threads) {
  constexpr uint64_t kMostThreads = 1024;
  if (threads > kMostThreads)
    throw Error(ErrorKind::usage, "--threads must be at most {}, found {}", kMostThreads, threads);
  return threads;
}

}  // namespace

ProcessScope::ProcessScope(const ProcessSettings& settings)
    : threads(checked_threads(settings.threads)),
      pixels(settings.max_megapixels),
      order(settings.order),
      cv_threads(cv::getNumThreads()),
      is_cv_optimized(cv::useOptimized()),
      cv_log_level(cv::utils::logging::getLogLevel()) {
  cv::setNumThreads(1);        // one frame per thread, instead of one frame in parallel
  cv::setUseOptimized(false);  // otherwise features depend on AVX2
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

ProcessScope::~ProcessScope() {
  cv::utils::logging::setLogLevel(static_cast<cv::utils::logging::LogLevel>(cv_log_level));
  cv::setUseOptimized(is_cv_optimized);
  cv::setNumThreads(cv_threads);
}

}  // namespace vpr
