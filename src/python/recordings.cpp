// The extension module stochastic_platoon._recordings: recorded platoons. It is separate from _platoon because it needs
// the libraries of ROS, which take longer to load.

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "python/convert.hpp"
#include "python/interruption.hpp"
#include "stochastic_platoon/math/model/input.hpp"
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

/// The values of one stream: a row per realization from `first` to before `end` and a column per step from -1 on, NaN
/// where the recording has none. An endless run has one row, which grows and always counts as whole.
class StreamTable {
public:
  StreamTable(const RunOptions& run, std::uint64_t first, std::uint64_t end)
      : first_(first), rows_(end - first), columns_(static_cast<std::size_t>(run.steps) + 1), grows_(run.steps == 0) {
    if (grows_) columns_ = 0;
    values_.assign(rows_ * columns_, std::nan(""));
    recorded_.assign(values_.size(), false);
  }

  void take(const stochastic_platoon::Position& message) {
    const auto column = static_cast<std::size_t>(message.step + 1);
    if (message.step < -1 || (!grows_ && column >= columns_)) return;
    if (grows_ && column >= values_.size()) values_.resize(column + 1, std::nan(""));
    for (std::size_t j = 0; j < message.position.size(); ++j) {
      const std::uint64_t row = message.first_realization + j - first_;  // wraps below the first one
      if (row >= rows_) continue;
      values_[row * columns_ + column] = message.position[j];
      if (!grows_) recorded_[row * columns_ + column] = true;
    }
  }

  /// The first column that a row lacks; none if the row is whole.
  std::optional<std::size_t> missing_in(std::size_t row) const {
    const auto begin = recorded_.begin() + static_cast<std::ptrdiff_t>(row * columns_);
    const auto end = begin + static_cast<std::ptrdiff_t>(columns_), missing = std::find(begin, end, false);
    return missing == end ? std::nullopt : std::optional<std::size_t>(missing - begin);
  }

  // For endless runs, whose number of steps is not known.
  void clear() { values_.clear(); }
  void extend_to(std::size_t size) { values_.resize(size, std::nan("")); }

  py::array_t<double> array() {
    const std::size_t columns = values_.size() / rows_;
    return array_of(std::move(values_), {rows_, columns});
  }

private:
  std::uint64_t first_;
  std::size_t rows_, columns_;
  bool grows_;
  std::vector<double> values_;
  std::vector<bool> recorded_;  ///< a value may be NaN itself
};

struct StreamTables {
  std::vector<StreamTable> tables;
  std::vector<bool> whole;  ///< by row: all streams have all steps of the realization
};

// A stream of one vehicle: position, predecessor_position, input, predecessor_input, received_position (the first
// position among its inputs), or received/<n> (its input n).
using StreamName = std::pair<std::string, std::size_t>;

std::string topic_of(const StreamName& of, const Configuration& configuration) {
  const auto& [stream, vehicle] = of;
  const std::size_t first = stream == "position" || stream == "input" ? 0 : 1;
  if (vehicle < first || vehicle > configuration.run.followers) {
    throw std::out_of_range("vehicle: " + std::to_string(vehicle) + ": must be from " + std::to_string(first) + " to " +
                            std::to_string(configuration.run.followers));
  }
  if (stream.rfind("received", 0) != 0) return "/" + vehicle_name(vehicle) + "/" + stream;
  const VehicleModel& own = platoon::vehicle(configuration.model, vehicle);
  const std::size_t input = stream == "received_position"
                                ? static_cast<std::size_t>(&own.position() - own.inputs.data())
                                : std::stoul(stream.substr(stream.find('/') + 1));
  if (input >= own.inputs.size()) {
    throw std::out_of_range("input: " + std::to_string(input) + ": must be from 0 to " +
                            std::to_string(own.inputs.size() - 1));
  }
  return "/" + received_topic(own, vehicle, input);
}

// Marks the whole rows. Throws BagError if one is not whole, unless the source accepts that.
std::vector<bool> whole_rows(const BagSource& source, const std::vector<StreamName>& streams,
                             const std::vector<StreamTable>& tables, std::uint64_t first, std::uint64_t end) {
  std::vector<bool> whole(end - first, true);
  for (std::size_t row = 0; row < whole.size(); ++row) {
    for (std::size_t at = 0; at < streams.size() && whole[row]; ++at) {
      const std::optional<std::size_t> missing = tables[at].missing_in(row);
      if (missing && source.accept == Accept::whole) {
        throw BagError(source.files.front() + ": the recording is not complete: " + streams[at].first + " of " +
                       vehicle_name(streams[at].second) + " lacks step " + std::to_string(std::int64_t(*missing) - 1) +
                       " of realization " + std::to_string(first + row) +
                       "; --partial (in Python partial=True) uses its whole realizations");
      }
      whole[row] = !missing;
    }
  }
  return whole;
}

// Tables of these streams, all read at once, with the realizations from `first` to before `end`. Throws
// std::out_of_range for a stream that is not in the recording.
StreamTables tables_of(const BagSource& source, const std::vector<StreamName>& streams, std::uint64_t first,
                       std::uint64_t end) {
  const Configuration configuration = recorded_platoon(source).configuration;
  const RunOptions& run = configuration.run;
  const std::uint64_t identity = run_identity(configuration);
  end = std::min(end, run.realizations);
  if (first >= end)
    throw std::out_of_range("realizations: " + std::to_string(first) + ": must be below " + std::to_string(end));
  std::map<PlatoonTopic::Key, std::size_t> places;
  for (std::size_t at = 0; at < streams.size(); ++at)
    places[parse_topic(topic_of(streams[at], configuration)).value().key()] = at;
  std::vector<StreamTable> tables(streams.size(), StreamTable(run, first, end));
  std::vector<bool> is_empty(streams.size(), true);
  // An attempt sends the values of the one before again, but in an endless run, which begins anew: there all streams of
  // the recording show the last attempt and its length.
  const bool endless = run.steps == 0;
  std::uint32_t attempt = 0;
  std::size_t longest = 0;
  BagStream bags(source, [&](const PlatoonTopic& topic) {
    return places.count(topic.key()) > 0 || (endless && topic.kind < PlatoonTopic::Kind::error_statistics);
  });
  while (const std::optional<RecordedMessage> recorded = bags.next()) {
    const auto at = places.find(recorded->topic.key());
    const auto message = recorded->position();
    if (message->run != identity) continue;
    if (at != places.end()) is_empty[at->second] = false;
    if (endless && message->attempt < attempt) continue;
    if (endless && message->attempt > attempt) {
      for (StreamTable& table : tables) table.clear();
      longest = 0;
    }
    attempt = message->attempt;
    if (message->step >= -1) longest = std::max(longest, static_cast<std::size_t>(message->step + 2));
    if (at != places.end()) tables[at->second].take(*message);
  }
  if (endless) {
    for (StreamTable& table : tables) table.extend_to(longest);
  }
  const auto missing = static_cast<std::size_t>(std::find(is_empty.begin(), is_empty.end(), true) - is_empty.begin());
  if (missing < streams.size()) {
    throw std::out_of_range("stream: " + streams[missing].first + " of " + vehicle_name(streams[missing].second) +
                            ": is not in the recording");
  }
  std::vector<bool> whole = whole_rows(source, streams, tables, first, end);
  return {std::move(tables), std::move(whole)};
}

py::tuple results_of(const BagSource& source, const std::optional<std::string>& signals) {
  ResultTables tables;
  std::string text;
  std::vector<std::string> findings;
  unlocked([&] {
    BagStatistics statistics =
        statistics_of_bags(source, nullptr, signals ? std::optional(signal_names(*signals)) : std::nullopt);
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
      [](const BagSource& source, const std::vector<StreamName>& streams, std::uint64_t first, std::uint64_t end) {
        StreamTables found = unlocked([&] { return tables_of(source, streams, first, end); });
        py::list arrays;
        for (StreamTable& table : found.tables) arrays.append(table.array());
        return py::make_tuple(arrays, found.whole);
      },
      py::arg("source"), py::arg("streams"), py::arg("first"), py::arg("end"));
  module.def("results", &results_of, py::arg("source"), py::arg("signals"));
}

}  // namespace platoon::python
