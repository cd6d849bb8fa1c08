// The extension module stochastic_platoon._recordings: recorded platoons. It is separate from _platoon because it needs
// the libraries of ROS, which take longer to load.

#include <pybind11/stl.h>

#include <cmath>

#include "python/convert.hpp"
#include "python/interruption.hpp"
#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"

namespace platoon::python {

namespace {

BagSource source_of(std::vector<std::string> files, bool partial, bool unverified) {
  if (files.empty()) throw std::invalid_argument("recording: no files: must be at least one bag");
  return {std::move(files), partial ? Accept::cut : Accept::whole, unverified};
}

/// The values of one stream: a row per realization and a column per step from -1 on, NaN where the recording has none.
/// An endless run has one row, which grows.
class StreamTable {
public:
  explicit StreamTable(const RunOptions& run)
      : rows_(run.realizations), columns_(static_cast<std::size_t>(run.steps) + 1), grows_(run.steps == 0) {
    if (grows_) columns_ = 0;
    values_.assign(rows_ * columns_, std::nan(""));
  }

  // A restarted attempt sends the same values again.
  void take(const stochastic_platoon::Position& message) {
    const auto column = static_cast<std::size_t>(message.step + 1);
    const std::size_t first = message.first_realization, count = message.position.size();
    if (message.step < -1 || first > rows_ || count > rows_ - first || (!grows_ && column >= columns_)) return;
    if (grows_ && column >= values_.size()) values_.resize(column + 1, std::nan(""));
    for (std::size_t j = 0; j < count; ++j) values_[(first + j) * columns_ + column] = message.position[j];
  }

  py::array_t<double> array() {
    const std::size_t columns = values_.size() / rows_;
    return array_of(std::move(values_), {rows_, columns});
  }

private:
  std::size_t rows_, columns_;
  bool grows_;
  std::vector<double> values_;
};

// `stream`: position, predecessor_position, input or predecessor_input.
StreamTable table_of(const BagSource& source, const std::string& stream, std::size_t vehicle) {
  const RunOptions run = recorded_platoon(source).configuration.run;
  const std::size_t first = stream == "predecessor_position" || stream == "predecessor_input" ? 1 : 0;
  if (vehicle < first || vehicle > run.followers) {
    throw std::out_of_range("vehicle: " + std::to_string(vehicle) + ": must be from " + std::to_string(first) + " to " +
                            std::to_string(run.followers));
  }
  const PlatoonTopic wanted = parse_topic("/" + vehicle_name(vehicle) + "/" + stream).value();
  StreamTable table(run);
  BagStream bags(source,
                 [&](const PlatoonTopic& topic) { return topic.kind == wanted.kind && topic.vehicle == vehicle; });
  bool is_empty = true;
  while (const std::optional<RecordedMessage> recorded = bags.next()) {
    table.take(*recorded->position());
    is_empty = false;
  }
  if (is_empty) {
    throw std::out_of_range("stream: " + stream + " of " + vehicle_name(vehicle) + ": is not in the recording");
  }
  return table;
}

py::tuple results_of(const BagSource& source, const std::optional<std::vector<std::string>>& signals) {
  ResultTables tables;
  std::string text;
  std::vector<std::string> findings;
  unlocked([&] {
    BagStatistics statistics = statistics_of_bags(source, nullptr, signals);
    if (statistics.result.realizations == 0)
      throw BagError(source.files.front() + ": holds no whole batch: there are no statistics");
    Configuration& configuration = statistics.configuration;
    configuration.run.hosting = Hosting::bag;
    configuration.run.output.clear();
    const Prediction prediction = predict(configuration);
    const auto files = result_files(configuration, prediction, statistics.result);
    tables = parse_results([&](const std::string& name) { return files.at(name); }, source.files.front());
    text = report(configuration, prediction, statistics.result);
    findings = statistics.findings;
  });
  return py::make_tuple(plain_object_of(tables.summary), dict_of(std::move(tables.tables)), text, findings);
}

}  // namespace

PYBIND11_MODULE(_recordings, module) {
  register_exceptions();
  py::register_exception<BagError>(module, "RecordingError", PyExc_ValueError);
  py::class_<BagSource>(module, "Source")
      .def(py::init(&source_of), py::arg("files"), py::arg("partial"), py::arg("unverified"));
  module.def("configuration", [](const BagSource& source) {
    return unlocked([&] { return to_json(recorded_platoon(source).configuration).dump(); });
  });
  module.def(
      "values",
      [](const BagSource& source, const std::string& stream, std::size_t vehicle) {
        return unlocked([&] { return table_of(source, stream, vehicle); }).array();
      },
      py::arg("source"), py::arg("stream"), py::arg("vehicle"));
  module.def("results", &results_of, py::arg("source"), py::arg("signals"));
}

}  // namespace platoon::python
