#include "python/call.h"

#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <vector>

#include "base/error.h"

namespace py = pybind11;

namespace vpr {
namespace {

/// Reports of the worker to the calling thread.
struct Reports {
  struct Step {
    std::string name;
    size_t done = 0;
    size_t total = 0;
  };
  std::optional<Step> step;  ///< the latest
  std::vector<std::string> warnings;
};

// Raises what Python code raises.
void deliver(const Reports& reports, const py::object& progress) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  for (const std::string& sentence : reports.warnings)
    if (PyErr_WarnEx(PyExc_UserWarning, sentence.c_str(), 2) != 0) throw py::error_already_set();
  if (reports.step && !progress.is_none())
    progress(reports.step->name, reports.step->done, reports.step->total);
}

/// Classes of the package, by ErrorKind.
constexpr std::array<const char*, 7> kClasses = {"UsageError",   "InputError",    "OutputError",
                                                 "DataError",    "InternalError", "Interrupted",
                                                 "InternalError"};

void raise(const Error& error) {
  if (error.kind() == ErrorKind::interrupted) return PyErr_SetNone(PyExc_KeyboardInterrupt);
  const char* name = kClasses[static_cast<size_t>(error.kind())];
  PyErr_SetString(py::module_::import("vpr").attr(name).ptr(), error.what());
}

}  // namespace

Call::Call(std::string name, const std::string& text, py::object observer, ProcessSettings initial)
    : function(std::move(name)),
      keywords(parse_json(text).value()),
      progress(std::move(observer)),
      process(initial) {
  take(process);
}

void Call::run(const std::function<void(const Monitor&)>& work) const {
  constexpr std::chrono::milliseconds kPeriod(50);
  static std::mutex turn;
  std::mutex mutex;  // of the reports
  Reports reports;
  std::atomic<bool> stop{false};
  Monitor monitor;
  monitor.stop = &stop;
  monitor.progress = [&](const std::string& step, size_t done, size_t total) {
    const std::scoped_lock lock(mutex);
    reports.step = {step, done, total};
  };
  monitor.warn = [&](const std::string& sentence) {
    const std::scoped_lock lock(mutex);
    reports.warnings.push_back(sentence);
  };
  std::future<void> result = std::async(std::launch::async, [&] {
    const std::scoped_lock lock(turn);
    const ProcessScope scope(process);
    work(monitor);
  });
  std::exception_ptr raised;
  for (bool is_finished = false; !is_finished;) {
    Reports latest;
    {
      const py::gil_scoped_release release;
      is_finished = result.wait_for(kPeriod) == std::future_status::ready;
      const std::scoped_lock lock(mutex);
      std::swap(latest, reports);
    }
    if (raised) continue;
    try {
      deliver(latest, progress);
    } catch (const py::error_already_set&) {
      raised = std::current_exception();
      stop = true;
    }
  }
  if (raised) std::rethrow_exception(raised);
  result.get();
}

RunInfo Call::run_info(const std::string& program) const {
  RunInfo run;
  run.program = program;
  run.command_line = {function};
  run.threads = thread_count();
  run.seed = process.seed;
  return run;
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
