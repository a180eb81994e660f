#include "python/call.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "base/error.h"
#include "base/parallel.h"

namespace py = pybind11;

namespace vpr {
namespace {

std::mutex work_mutex;

/// Settings of the process while work runs.
struct WorkScope {
  explicit WorkScope(const CallSettings& call)
      : threads(call.threads), pixels(call.max_megapixels), order(call.order) {
    cv::setNumThreads(1);        // one frame per thread, instead of one frame in parallel
    cv::setUseOptimized(false);  // otherwise features depend on AVX2
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  }
  ~WorkScope() {
    cv::utils::logging::setLogLevel(log_level);
    cv::setUseOptimized(is_optimized);
    cv::setNumThreads(cv_threads);
  }
  WorkScope(const WorkScope&) = delete;
  WorkScope& operator=(const WorkScope&) = delete;

  std::scoped_lock<std::mutex> lock{work_mutex};
  ThreadLimit threads;
  MegapixelLimit pixels;
  FrameOrderScope order;
  int cv_threads = cv::getNumThreads();
  bool is_optimized = cv::useOptimized();
  cv::utils::logging::LogLevel log_level = cv::utils::logging::getLogLevel();
};

/// Reports of the worker to the calling thread.
struct Reports {
  struct Step {
    std::string name;
    size_t done = 0;
    size_t total = 0;
  };
  std::mutex mutex;
  std::condition_variable change;
  std::optional<Step> step;
  std::vector<std::string> warnings;
  bool is_finished = false;
};

// Raises what Python code raises.
void deliver(const std::optional<Reports::Step>& step, const std::vector<std::string>& warnings,
             const py::object& progress) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  for (const std::string& sentence : warnings)
    if (PyErr_WarnEx(PyExc_UserWarning, sentence.c_str(), 2) != 0) throw py::error_already_set();
  if (step && !progress.is_none()) progress(step->name, step->done, step->total);
}

// Until the work is finished. Returns what Python code raised first.
std::exception_ptr follow(Reports& reports, std::atomic<bool>& stop, const py::object& progress) {
  constexpr std::chrono::milliseconds kPeriod(50);
  std::exception_ptr raised;
  for (bool is_finished = false; !is_finished;) {
    std::optional<Reports::Step> step;
    std::vector<std::string> warnings;
    {
      const py::gil_scoped_release release;
      std::unique_lock lock(reports.mutex);
      reports.change.wait_for(lock, kPeriod, [&] { return reports.is_finished; });
      is_finished = reports.is_finished;
      std::swap(step, reports.step);
      std::swap(warnings, reports.warnings);
    }
    if (raised) continue;
    try {
      deliver(step, warnings, progress);
    } catch (const py::error_already_set&) {
      raised = std::current_exception();
      stop = true;
    }
  }
  return raised;
}

/// Classes of the package, by ErrorKind.
constexpr std::array<const char*, 7> kClasses = {"UsageError",   "InputError",       "OutputError",
                                                 "DataError",    "ExpectationError", "Interrupted",
                                                 "InternalError"};

void raise(const Error& error) {
  if (error.kind() == ErrorKind::interrupted) return PyErr_SetNone(PyExc_KeyboardInterrupt);
  const char* name = kClasses[static_cast<size_t>(error.kind())];
  PyErr_SetString(py::module_::import("vpr").attr(name).ptr(), error.what());
}

}  // namespace

std::vector<std::string> Keywords::keys() const {
  std::vector<std::string> keys;
  for (const auto& item : json_.items()) keys.push_back(item.key());
  return keys;
}

RunInfo run_info(const std::string& program, const std::string& function,
                 const CallSettings& call) {
  RunInfo run;
  run.program = program;
  run.command_line = {function};
  run.threads = thread_count();
  run.seed = call.seed;
  return run;
}

void run_call(const CallSettings& call, const py::object& progress,
              const std::function<void(const Monitor&)>& work) {
  Reports reports;
  std::atomic<bool> stop{false};
  Monitor monitor;
  monitor.stop = &stop;
  monitor.progress = [&](const std::string& step, size_t done, size_t total) {
    const std::scoped_lock lock(reports.mutex);
    reports.step = {step, done, total};
  };
  monitor.warn = [&](const std::string& sentence) {
    const std::scoped_lock lock(reports.mutex);
    reports.warnings.push_back(sentence);
  };
  std::exception_ptr failure;
  std::thread worker([&] {
    try {
      const WorkScope scope(call);
      work(monitor);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::scoped_lock lock(reports.mutex);
    reports.is_finished = true;
    reports.change.notify_all();
  });
  const std::exception_ptr raised = follow(reports, stop, progress);
  worker.join();
  if (raised) std::rethrow_exception(raised);
  if (failure) std::rethrow_exception(failure);
}

void translate_errors() {
  // NOLINTNEXTLINE(performance-unnecessary-value-param): the signature that pybind11 needs
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    } catch (const std::filesystem::filesystem_error& error) {
      raise({ErrorKind::output, fmt::format("{}: cannot be read or written: {}",
                                            error.path1().string(), error.code().message())});
    }
  });
}

}  // namespace vpr
