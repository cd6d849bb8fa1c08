#include "python/convert.hpp"

#include <pybind11/stl.h>

#include <cmath>
#include <system_error>
#include <utility>
#include <variant>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/yaml_value.hpp"

namespace platoon::python {

namespace {

bool is_number(const nlohmann::json& value) {
  return value.is_number() || value.is_null();
}

// Whether it is a list of numbers with at least one.
bool is_row(const nlohmann::json& value) {
  if (!value.is_array() || value.empty()) return false;
  for (const nlohmann::json& element : value) {
    if (!is_number(element)) return false;
  }
  return true;
}

bool is_matrix(const nlohmann::json& value) {
  if (!value.is_array() || value.empty()) return false;
  for (const nlohmann::json& row : value) {
    if (!is_row(row) || row.size() != value.front().size()) return false;
  }
  return true;
}

// Raises what a signal's handler raises, as KeyboardInterrupt.
void append(const nlohmann::json& row, std::vector<double>& values) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  for (const nlohmann::json& element : row) values.push_back(element.is_null() ? std::nan("") : element.get<double>());
}

py::object object_of(const nlohmann::json& value, bool with_arrays) {
  switch (value.type()) {
    case nlohmann::json::value_t::null:
      return py::none();
    case nlohmann::json::value_t::boolean:
      return py::bool_(value.get<bool>());
    case nlohmann::json::value_t::number_integer:
      return py::int_(value.get<std::int64_t>());
    case nlohmann::json::value_t::number_unsigned:
      return py::int_(value.get<std::uint64_t>());
    case nlohmann::json::value_t::number_float:
      return py::float_(value.get<double>());
    case nlohmann::json::value_t::string:
      return py::cast(value.get<std::string>());
    case nlohmann::json::value_t::object: {
      py::dict object;
      for (const auto& [key, element] : value.items()) object[py::cast(key)] = object_of(element, with_arrays);
      return object;
    }
    default:
      break;
  }
  std::vector<double> values;
  if (with_arrays && (is_row(value) || value.empty())) {
    append(value, values);
    return array_of(std::move(values));
  }
  if (with_arrays && is_matrix(value)) {
    for (const nlohmann::json& row : value) append(row, values);
    return array_of(std::move(values), {value.size(), value.front().size()});
  }
  py::list list;
  for (const nlohmann::json& element : value) list.append(object_of(element, with_arrays));
  return list;
}

}  // namespace

py::object object_of(const nlohmann::json& value) {
  return object_of(value, true);
}

py::object plain_object_of(const nlohmann::json& value) {
  return object_of(value, false);
}

py::object object_of(const YAML::Node& value, const std::string& name) {
  if (value.IsMap()) {
    py::dict keys;
    for (const auto& entry : value) {
      const std::string text = entry.first.IsScalar() ? entry.first.Scalar() : shown(entry.first);
      const std::string at = name + ": " + text;
      const py::object key = py::cast(text);
      if (keys.contains(key)) throw ConfigurationError({at + ": given twice: must be given once"});
      keys[key] = object_of(entry.second, at);
    }
    return keys;
  }
  if (value.IsSequence()) {
    py::list list;
    for (const YAML::Node& element : value) list.append(object_of(element, name));
    return list;
  }
  if (value.IsNull()) return py::none();
  const std::string& text = value.Scalar();
  if (value.Tag() == "!") return py::cast(text);  // in quotes
  if (const auto boolean = parsed_boolean(value)) return py::bool_(*boolean);
  if (const auto integer = parsed_integer(value)) return py::int_(*integer);
  double number;
  if (YAML::convert<double>::decode(value, number)) return py::float_(number);
  return py::cast(text);
}

py::dict dict_of(CsvTable table) {
  py::dict columns;
  for (std::size_t j = 0; j < table.names.size(); ++j) {
    // Not py::str, which raises RuntimeError in pybind11 2.6 if the name is not UTF-8; this is a ValueError.
    const py::object name = py::cast(table.names[j]);
    if (auto* numbers = std::get_if<std::vector<double>>(&table.columns[j])) {
      columns[name] = array_of(std::move(*numbers));
    } else {
      columns[name] = py::cast(std::get<std::vector<std::string>>(table.columns[j]));
    }
  }
  return columns;
}

py::dict dict_of(std::map<std::string, CsvTable> tables) {
  py::dict named;
  for (auto& entry : tables) named[py::cast(entry.first)] = dict_of(std::move(entry.second));
  return named;
}

void register_exceptions() {
  // NOLINTNEXTLINE(performance-unnecessary-value-param): the signature is that of pybind11.
  py::register_exception_translator([](std::exception_ptr raised) {
    try {
      if (raised) std::rethrow_exception(raised);
    } catch (const ConfigurationError& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    } catch (const std::system_error& error) {
      const bool is_missing = error.code() == std::errc::no_such_file_or_directory;
      PyErr_SetString(is_missing ? PyExc_FileNotFoundError : PyExc_OSError, error.what());
    }
  });
}

}  // namespace platoon::python
