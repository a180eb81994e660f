// Calls, arrays, databases, and the module itself.
#include "python/module.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <future>
#include <map>
#include <mutex>
#include <new>
#include <thread>

#include <fmt/ranges.h>
#include <unistd.h>

#include "base/error.h"
#include "base/provenance.h"
#include "base/simd.h"
#include "base/text.h"
#include "present/database_report.h"

namespace py = pybind11;

namespace vpr {

namespace {

/// The threads that are in a call, and the end of the interpreter. Threads that hold the
/// interpreter's lock change it.
struct Callers {
  std::mutex mutex;
  std::condition_variable left;
  std::map<std::thread::id, size_t> depths;  ///< calls of a thread, each within the one before
  std::atomic<bool> is_ended{false};         ///< the interpreter ends
  std::thread::id last;                      ///< the thread that ends it, which may still call
  bool lacks_threads = false;                ///< forked during the call of another thread

  // Later, a thread could not take the interpreter's lock to return from its call.
  void wait_for_others() {
    std::unique_lock lock(mutex);
    last = std::this_thread::get_id();
    is_ended = true;
    left.wait(lock, [&] { return depths.size() == depths.count(last); });
  }
};

Callers& callers() {
  static Callers all;
  return all;
}

// A forked process has only the thread that forked it.
void forget_threads() {
  Callers& all = callers();
  all.lacks_threads = all.lacks_threads || !all.depths.empty();
  std::erase_if(all.depths,
                [](const auto& call) { return call.first != std::this_thread::get_id(); });
}

// As threads that wait for the lock of an ended interpreter.
[[noreturn]] void wait_for_ever() {
  const py::gil_scoped_release release;
  for (;;) ::pause();
}

}  // namespace

InCall::InCall() {
  Callers& all = callers();
  const std::thread::id own = std::this_thread::get_id();
  if (all.is_ended && own != all.last && !all.depths.contains(own)) wait_for_ever();
  if (all.lacks_threads)
    throw Error(ErrorKind::usage,
                "this process was forked while another thread was in a call of vpr. Start "
                "processes with the method spawn: multiprocessing.get_context(\"spawn\")");
  if (all.is_ended && own != all.last)
    throw Error(ErrorKind::interrupted, "interrupted: the interpreter ends");
  const std::scoped_lock lock(all.mutex);
  ++all.depths[own];
}

InCall::~InCall() {
  Callers& all = callers();
  const std::thread::id own = std::this_thread::get_id();
  std::unique_lock lock(all.mutex);
  const auto found = all.depths.find(own);
  if (--found->second > 0) return;
  all.depths.erase(found);
  all.left.notify_all();
  lock.unlock();
  // An error would be printed while the interpreter ends, which aborts it (Python 3.13).
  if (all.is_ended && own != all.last) wait_for_ever();
}

std::string Call::shown(std::string sentence) const {
  for (size_t at = 0; !folder.empty() && (at = sentence.find(folder, at)) != std::string::npos;)
    sentence.erase(at, folder.size());
  return sentence;
}

void Call::run(const std::function<void(const Monitor&)>& work) const {
  /// News of the work for the calling thread.
  struct Reports {
    std::function<void()> progress;  ///< of the latest step; null: no news
    std::vector<std::string> warnings;
  };
  constexpr std::chrono::milliseconds kPeriod(50);
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
    reports.warnings.push_back(shown(sentence));
  };
  std::future<void> result = std::async(std::launch::async, [&] {
    const calls::ProcessTurn turn(keywords.process, monitor);
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
    if (callers().is_ended && std::this_thread::get_id() != callers().last) stop = true;
    if (raised) continue;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      for (const std::string& sentence : latest.warnings)
        if (PyErr_WarnEx(PyExc_UserWarning, sentence.c_str(), 2) != 0)
          throw py::error_already_set();
      if (latest.progress) latest.progress();
    } catch (const py::error_already_set&) {
      raised = std::current_exception();
      stop = true;
    }
  }
  if (raised) std::rethrow_exception(raised);
  try {
    result.get();
  } catch (const Error& error) {
    throw Error(error.kind(), shown(error.what()));
  }
}

py::object refuse_new(const py::object& type, const py::args& /*arguments*/,
                      const py::kwargs& /*more*/) {
  throw py::type_error(fmt::format("{} objects are made by the functions of vpr, such as load",
                                   std::string(py::str(type.attr("__name__")))));
}

void save(const std::function<void()>& write) {
  Call{{"vpr.save", Json::object()}}.run([&](const Monitor&) { write(); });
}

py::array array_of(const py::object& values, const std::string& name) {
  if (py::module_::import("numpy").attr("ma").attr("is_masked")(values).cast<bool>())
    throw Error(
        ErrorKind::data,
        "{}: has masked values. Replace them by filled(): scores with numpy.nan, labels with 0",
        name);
  py::array array(values);
  if (std::string_view("biuf").find(array.dtype().kind()) == std::string_view::npos)
    throw Error(ErrorKind::data, "{}: is not an array of numbers (its type is {})", name,
                std::string(py::str(array.dtype())));
  return array;
}

std::shared_ptr<const NpyArray> view_of(py::array array, const std::string& name) {
  const bool is_fortran = (array.flags() & (py::array::c_style | py::array::f_style)) ==
                          py::array::f_style;  // a vector is in both orders
  if (!is_fortran) array = py::array::ensure(array, py::array::c_style);
  if (!array) throw std::bad_alloc();
  NpyHeader header{py::str(array.dtype().attr("str")), {}, is_fortran};
  header.shape.assign(array.shape(), array.shape() + array.ndim());
  const std::span values(static_cast<const std::byte*>(array.data()),
                         static_cast<size_t>(array.nbytes()));
  const auto release = [owner = array.inc_ref().ptr()](const NpyArray* view) {
    delete view;
    const py::gil_scoped_acquire acquire;
    Py_DECREF(owner);
  };
  return {new NpyArray(name, header, values), release};
}

std::vector<NamedArgument> arguments_of(const Sources& sources, const std::string& array_name) {
  std::vector<calls::Frames> frames;
  for (const auto& [name, source] : sources) {
    if (const auto* path = std::get_if<std::filesystem::path>(&source)) {
      frames.push_back({name, *path});
      continue;
    }
    const auto& array = std::get<py::object>(source);
    if (array.is_none())
      throw Error(ErrorKind::usage, "frames are missing: pass images or descriptors");
    frames.push_back({name, [array](const std::string& shown) {
                        return view_of(array_of(array, shown), shown);
                      }});
  }
  return calls::named_arguments(frames, array_name);
}

py::object fields_of(const Json& json) {
  return py::module_::import("vpr").attr("_read")(to_line(json));
}

namespace {

calls::DatabasePointer train(Call& call, const Sources& sources, const Sources& other) {
  const std::vector<NamedArgument> named = arguments_of(sources, "train");
  std::vector<SequenceArgument> pretrain;
  for (const NamedArgument& one : arguments_of(other, "pretrain")) pretrain.push_back(one.sequence);
  calls::DatabasePointer made;
  call.run([&](const Monitor& monitor) {
    made = calls::train(call.keywords, named, pretrain, monitor);
  });
  return made;
}

// A view that keeps the database.
py::array descriptors_of(const calls::DatabasePointer& database) {
  const DescriptorRows& rows = database->sequences().descriptors.rows();
  const ElementType element = rows.shape.element;
  const bool is_wide = element == ElementType::int16 || element == ElementType::points16;
  const char* type = is_wide ? "i2" : element == ElementType::int8 ? "i1" : "u1";
  const std::vector<size_t> shape = {rows.size(), rows.shape.row_bytes() / (is_wide ? 2 : 1)};
  py::array array(py::dtype(type), shape, rows.bytes.data(), py::cast(database));
  array.attr("flags").attr("writeable") = false;
  return array;
}

void add_databases(py::module_& module) {
  using namespace py::literals;
  const auto described = [](const calls::Database& database) {
    const std::string names = fmt::format("{}", fmt::join(database.names(), ", "));
    const auto* sequences = std::get_if<SequenceDatabase>(&database.content);
    if (sequences == nullptr) return "FAB-MAP, places " + names;
    return fmt::format("{} of {}, {}", counted(sequences->descriptors.rows().size(), "frame"),
                       names, sequences->descriptors.kind->name);
  };
  const auto shown = [](const calls::Database& database) {
    const auto* sequences = std::get_if<SequenceDatabase>(&database.content);
    const std::string text = sequences == nullptr
                                 ? fmt::format("{}", fmt::join(database.names(), "\n"))
                                 : database_text(*sequences, "Database");
    return "<pre>" + html_escaped(text) + "</pre>";
  };
  py::class_<calls::Database, calls::DatabasePointer>(module, "Database",
                                                      "Training sequences, from train or load.")
      .def_static("__new__", refuse_new)
      .def(
          "save",
          [](const calls::Database& database, const std::filesystem::path& path, bool force) {
            save([&] { calls::save(database, path, force); });
          },
          py::call_guard<InCall>(), "path"_a, "force"_a = false,
          "Writes the folder that vpr-train writes. force: replaces a database.")
      .def(
          "__repr__",
          [described](const calls::Database& database) {
            return "<vpr.Database: " + described(database) + ">";
          },
          py::call_guard<InCall>())
      .def("_repr_html_", shown, py::call_guard<InCall>())
      .def_property_readonly("sequences", &calls::Database::names,
                             "Names of the training sequences.")
      .def_property_readonly(
          "descriptors", py::cpp_function(descriptors_of, py::call_guard<InCall>()),
          "Stored descriptors, one row per frame of all sequences, as a read-only view: bits (8 "
          "per\nvalue) and images are uint8, vectors int16 or int8. Not for FAB-MAP.");
  module.def("train", train, py::call_guard<InCall>());
  const auto load = [](const Call& call, const std::filesystem::path& path) {
    calls::DatabasePointer database;
    call.run([&](const Monitor&) { database = calls::read_database(path); });
    return database;
  };
  module.def("load_database", load, py::call_guard<InCall>());
}

void raise(const Error& error) {
  constexpr std::array kClasses = {"UsageError", "InputError", "OutputError", "DataError"};
  const auto kind = static_cast<size_t>(error.kind());
  const char* name = kind < kClasses.size() ? kClasses[kind] : "InternalError";
  const std::string_view text = error.what();  // with any bytes of paths
  const auto sentence = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
  PyErr_SetObject(py::module_::import("vpr").attr(name).ptr(), sentence.ptr());
}

}  // namespace

PYBIND11_MODULE(_vpr, module) {
  using namespace py::literals;
  py::options options;
  options.disable_function_signatures();
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
  const char* simd = std::getenv("VPR_SIMD");
  use_simd_target(simd == nullptr ? "" : simd);
  module.attr("__version__") = program_version();
  py::class_<Call>(module, "Call")
      .def(py::init(
          [](const std::string& function, const std::string& keywords, const py::object& progress) {
            std::optional<Json> json = parse_json(keywords);
            if (!json) throw Error(ErrorKind::usage, "{}: a setting is not valid text", function);
            return Call{{function, *std::move(json)}, progress};
          }))
      .def_readwrite("folder", &Call::folder);
  module.def("array_of", array_of, py::call_guard<InCall>());
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    const py::gil_scoped_release release;
    callers().wait_for_others();
  }));
  py::module_::import("os").attr("register_at_fork")("after_in_child"_a =
                                                         py::cpp_function(forget_threads));
  add_databases(module);
  add_queries(module);
  add_evaluations(module);
}

}  // namespace vpr
