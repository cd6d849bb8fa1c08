#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/run/io/csv_table.hpp"

namespace platoon::python {

namespace py = pybind11;

/// The values, in the order of the rows, as an array of this shape that owns them, without a copy.
template <typename T>
py::array_t<T> array_of(std::vector<T> values, py::array::ShapeContainer shape) {
  auto* kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* pointer) { delete static_cast<std::vector<T>*>(pointer); });
  return py::array_t<T>(std::move(shape), kept->data(), owner);
}

/// The same with one dimension.
template <typename T>
py::array_t<T> array_of(std::vector<T> values) {
  const std::size_t size = values.size();
  return array_of(std::move(values), {size});
}

/// A JSON value in Python: lists of numbers, of one or two dimensions, become arrays of float with NaN for null; all
/// other values are as json.loads returns them.
py::object object_of(const nlohmann::json& value);

/// A JSON value as json.loads returns it.
py::object plain_object_of(const nlohmann::json& value);

/// A YAML value: a scalar without quotes is None, True, False, an integer or a float where it can be one, else a text.
/// Throws ConfigurationError, starting with `name`, for a key that is given twice.
py::object object_of(const YAML::Node& value, const std::string& name);

/// {name: array of float, or list of str}.
py::dict dict_of(CsvTable table);

/// The tables by name, each as {name: array of float, or list of str}.
py::dict dict_of(std::map<std::string, CsvTable> tables);

/// Raises the Python exceptions that correspond to this package's, with the same texts: ValueError for invalid
/// arguments, FileNotFoundError and OSError for files. pybind11 2.4 has no translators of one module alone: the OSError
/// for std::system_error holds for all its modules in this process.
void register_exceptions();

}  // namespace platoon::python
