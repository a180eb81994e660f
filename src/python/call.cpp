#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <mutex>

#include "base/error.h"
#include "match/row_kernels.h"
#include "python/module.h"

namespace py = pybind11;

namespace vpr {
namespace {

/// Reports of the worker to the calling thread.
struct Reports {
  std::function<void()> progress;  ///< of the latest step; null: no news
  std::vector<std::string> warnings;
};

// Raises what Python code raises.
void deliver(const Reports& reports) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  for (const std::string& sentence : reports.warnings)
    if (PyErr_WarnEx(PyExc_UserWarning, sentence.c_str(), 2) != 0) throw py::error_already_set();
  if (reports.progress) reports.progress();
}

void raise(const Error& error) {
  constexpr std::array kClasses = {"UsageError",    "InputError",  "OutputError",  "DataError",
                                   "InternalError", "Interrupted", "InternalError"};
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
  if (!progress.is_none())
    monitor.progress = [&](const std::string& step, size_t done, size_t total) {
      const std::scoped_lock lock(mutex);
      reports.progress = [this, step, done, total] { progress(step, done, total); };
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
    try {
      if (!raised) deliver(latest);
    } catch (const py::error_already_set&) {
      raised = std::current_exception();
      stop = true;
    }
  }
  if (raised) std::rethrow_exception(raised);
  result.get();
}

RunInfo Call::run_info(const std::string& program) const {
  return {.program = program,
          .command_line = {function},
          .paths = {},
          .simd_target = std::string(select_kernels().target),
          .threads = thread_count(),
          .seed = process.seed};
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
