#include "stochastic_platoon/run/results/trajectories_csv.hpp"

#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "stochastic_platoon/run/io/csv_text.hpp"

namespace platoon {

namespace {

// None beyond the end.
std::optional<double> value_at(const std::vector<double>& values, std::size_t index) {
  return index < values.size() ? std::optional(values[index]) : std::nullopt;
}

}  // namespace

std::string trajectories_csv(const Configuration& configuration, std::uint64_t realization) {
  const RunOptions& run = configuration.run;
  if (realization >= run.realizations) {
    throw ConfigurationError({"only: " + std::to_string(realization) + ": must be below the " +
                              std::to_string(run.realizations) + " realizations of the run"});
  }
  std::vector<std::string> names;
  for (const SignalKind& kind : signal_kinds()) names.emplace_back(kind.name);
  CsvText csv("vehicle,step,seconds,position,received_position,input,received_input,tracking_error");
  for (const std::string& name : names) csv.add(name);
  csv.end_row();
  const std::vector<Trajectory> all =
      trajectories(configuration.model, run.seed, run.followers, run.steps, realization, names);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Trajectory& of = all[i];
    for (std::size_t a = 0; a < of.position.size(); ++a) {
      const std::int64_t step = static_cast<std::int64_t>(a) - 1;
      csv.add(i, step, formatted("%.10g", static_cast<double>(step) * configuration.model.sample_period));
      for (const auto* values : {&of.position, &of.received, &of.input, &of.received_input})
        csv.add(value_at(*values, a));
      for (std::size_t kind = 0; kind <= names.size(); ++kind)
        csv.add(of.signals.empty() || a == 0 ? std::nullopt : value_at(of.signals[kind], a - 1));
      csv.end_row();
    }
  }
  return csv.text();
}

}  // namespace platoon
