#include "python/module.h"

namespace py = pybind11;

namespace vpr {

std::shared_ptr<const NpyArray> view_of(py::array array, const std::string& name) {
  const bool is_c = (array.flags() & py::array::c_style) != 0;
  const bool is_fortran = !is_c && (array.flags() & py::array::f_style) != 0;
  if (!is_c && !is_fortran) array = py::array::ensure(array, py::array::c_style);
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

SequenceArgument sequence_of(const py::object& source, const std::string& name) {
  if (!py::isinstance<py::array>(source)) return parse_sequence_argument(py::str(source));
  SequenceArgument argument{name, {}};
  argument.array = view_of(source, name);
  return argument;
}

ScoreInput scores_of(const py::object& source) {
  if (!py::isinstance<py::array>(source)) return {py::str(source)};
  return {"scores", view_of(source, "scores")};
}

std::vector<NamedArgument> arguments_of(const Sources& sources) {
  std::vector<SequenceArgument> arguments;
  for (const auto& [name, source] : sources) arguments.push_back(sequence_of(source, name));
  const std::vector<std::string> names = sequence_names(arguments);
  std::vector<NamedArgument> named;
  for (size_t i = 0; i < arguments.size(); ++i)
    named.push_back({sources[i].first.empty() ? names[i] : sources[i].first, arguments[i]});
  return named;
}

py::object fields_of(const Json& json) {
  return py::module_::import("vpr").attr("_read")(to_line(json));
}

py::array view_of(const DescriptorRows& rows, const py::object& owner) {
  const ElementType element = rows.shape.element;
  const bool is_wide = element == ElementType::int16 || element == ElementType::points16;
  const char* type = is_wide ? "i2" : element == ElementType::int8 ? "i1" : "u1";
  const std::vector<size_t> shape = {rows.size(), rows.shape.row_bytes() / (is_wide ? 2 : 1)};
  py::array array(py::dtype(type), shape, rows.bytes.data(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::array array_of(const ResultArray& array) {
  py::list fields;
  for (const std::string_view column : array.columns)
    fields.append(py::make_tuple(column, array.type));
  const py::dtype type =
      array.columns.size() > 1 ? py::dtype::from_args(fields) : py::dtype(std::string(array.type));
  return {type, array.rows, array.values.data()};
}

}  // namespace vpr
