// Queries whose frames arrive one by one.
#include <opencv2/core.hpp>

#include "base/error.h"
#include "files/live_lines.h"
#include "python/module.h"

namespace py = pybind11;

namespace vpr {
namespace {

// A copy of the pixels.
std::shared_ptr<const cv::Mat> picture_of(const py::object& frame) {
  const auto pixels = py::array_t<uint8_t, py::array::c_style>::ensure(frame);
  if (!pixels || pixels.ndim() < 2 || pixels.ndim() > 3 ||
      (pixels.ndim() == 3 && pixels.shape(2) != 3))
    throw Error(ErrorKind::data,
                "an image has height x width gray levels, or height x width x 3 values (blue, "
                "green, red), of type uint8");
  const cv::Mat view(static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(1)),
                     pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3, const_cast<uint8_t*>(pixels.data()));
  return std::make_shared<const cv::Mat>(view.clone());
}

struct Live {
  Call call;
  std::shared_ptr<SequenceDatabase> database;
  std::optional<LiveLines> lines;

  Live(const DatabasePointer& trained, const std::string& text) : call("vpr.Live", text) {
    const QueryChoices by(call, Feature::live);
    call.run([&](const Monitor& monitor) {
      database = by.prepare(trained, monitor);
      lines.emplace(*database, "live", by.settings, by.resources, monitor);
    });
  }

  py::object add(const py::object& frame, const std::string& name) {
    LiveFrame image;
    image.name = name;
    if (!py::isinstance<py::array>(frame))
      image.file = std::string(py::str(frame));
    else if (database->descriptors.kind->is_imported)
      image.array = view_of(py::array(frame.attr("reshape")(1, -1)), name);
    else
      image.picture = picture_of(frame);
    Json line;
    call.run([&](const Monitor& monitor) {
      line = frame.is_none() ? lines->take_missing(name) : lines->take(image, monitor);
    });
    return fields_of(line);
  }

  py::object finish() {
    std::optional<Json> line;
    call.run([&](const Monitor&) { line = lines->finish(); });
    return line ? fields_of(*line) : py::none();
  }
};

}  // namespace

void add_live(py::module_& module) {
  py::class_<Live>(module, "Live")
      .def(py::init<DatabasePointer, const std::string&>())
      .def("add", &Live::add)
      .def("finish", &Live::finish);
}

}  // namespace vpr
