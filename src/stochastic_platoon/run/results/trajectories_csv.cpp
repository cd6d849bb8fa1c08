#include "stochastic_platoon/run/results/trajectories_csv.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "stochastic_platoon/run/io/csv_text.hpp"

namespace platoon {

namespace {

// The position and the control input of the predecessor have names of their own; any other input has that of its place.
std::string name_of_received(const VehicleModel& vehicle, std::size_t input) {
  const Input& of = vehicle.inputs[input];
  const bool alone = vehicle.hears_predecessor_only();
  if (of.signal == InputSignal::position && (alone || &of == &vehicle.position())) return "received_position";
  if (alone) return "received_input";
  return "received_" + std::to_string(input);
}

}  // namespace

TrajectoryColumns trajectory_columns(const Configuration& configuration, std::uint64_t realization,
                                     const std::shared_ptr<const ChangedDraws>& changes) {
  const RunOptions& run = configuration.run;
  if (realization >= run.realizations) {
    throw ConfigurationError({"only: " + std::to_string(realization) + ": must be below the " +
                              std::to_string(run.realizations) + " realizations of the run"});
  }
  const std::size_t steps = static_cast<std::size_t>(run.steps) + 1, size = (run.followers + 1) * steps;
  TrajectoryColumns columns;
  for (std::size_t a = 0; a < steps; ++a) {
    check_interruption();
    const double second = (static_cast<double>(a) - 1.0) * configuration.model.sample_period;
    columns.seconds.push_back(*number_in(formatted("%.10g", second)));
  }
  std::vector<std::string> names;
  const auto add_column = [&columns, size](const std::string& name) {
    check_interruption();
    columns.quantities.emplace_back(name, std::vector<double>(size, kNaN));
  };
  for (const char* name : {"position", "received_position", "input", "received_input", "tracking_error"})
    add_column(name);
  for (const SignalKind& kind : signal_kinds()) {
    names.emplace_back(kind.name);
    if (names.back() != kInput) add_column(kind.name);  // has its column already
  }
  std::size_t begin = 0, vehicle_index = 0;
  const auto add = [&](const std::string& name, const std::vector<double>& values, std::size_t first) {
    auto column = std::find_if(columns.quantities.begin(), columns.quantities.end(),
                               [&name](const auto& quantity) { return quantity.first == name; });
    if (column == columns.quantities.end())
      column = columns.quantities.insert(column, {name, std::vector<double>(size, kNaN)});
    std::copy(values.begin(), values.end(), &column->second[begin + first]);
  };
  for_each_trajectory(configuration.model, WhiteNoise(run.seed, changes), run.followers, run.steps, realization, names,
                      [&](const Trajectory& of) {
                        add("position", of.position, 0);
                        add("input", of.input, 0);
                        for (std::size_t n = 0; n < of.received.size(); ++n)
                          add(name_of_received(vehicle(configuration.model, vehicle_index), n), of.received[n], 0);
                        for (std::size_t s = 0; s < of.signals.size(); ++s)  // from step 0 on
                          add(s == 0 ? "tracking_error" : names[s - 1], of.signals[s], 1);
                        begin += steps;
                        ++vehicle_index;
                      });
  return columns;
}

std::string trajectories_csv(const Configuration& configuration, std::uint64_t realization,
                             const std::shared_ptr<const ChangedDraws>& changes) {
  const TrajectoryColumns columns = trajectory_columns(configuration, realization, changes);
  CsvText csv("vehicle,step,seconds");
  for (const auto& quantity : columns.quantities) csv.add(quantity.first);
  csv.end_row();
  const std::size_t steps = columns.seconds.size();
  for (std::size_t row = 0; row < (configuration.run.followers + 1) * steps; ++row) {
    check_interruption();
    csv.add(row / steps, static_cast<std::int64_t>(row % steps) - 1, formatted("%.10g", columns.seconds[row % steps]));
    for (const auto& quantity : columns.quantities) {
      const double value = quantity.second[row];
      csv.add(std::isnan(value) ? std::nullopt : std::optional(value));
    }
    csv.end_row();
  }
  return csv.text();
}

}  // namespace platoon
