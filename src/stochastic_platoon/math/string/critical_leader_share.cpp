#include "stochastic_platoon/math/string/critical_leader_share.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/string/varied_margins.hpp"

namespace platoon {

namespace {

/// Sums of the weights of a vehicle's positions.
struct Weights {
  double leader = 0.0, others = 0.0;

  explicit Weights(const VehicleModel& vehicle) {
    for (const Input& input : vehicle.inputs) {
      if (input.signal == InputSignal::position) (input.ahead == Input::kLeader ? leader : others) += input.gain;
    }
  }

  bool are_shared() const { return leader != 0.0 && others != 0.0; }
};

}  // namespace

PlatoonModel with_leader_share(PlatoonModel model, double share) {
  for (VehicleType& type : model.types) {
    const Weights weights(type.vehicle);
    if (!weights.are_shared()) continue;
    for (Input& input : type.vehicle.inputs) {
      if (input.signal != InputSignal::position) continue;
      input.gain *= input.ahead == Input::kLeader ? share / weights.leader : (1.0 - share) / weights.others;
    }
  }
  return model;
}

std::optional<StableLeaderShares> stable_leader_shares(const PlatoonModel& model) {
  constexpr int kSamples = 20;
  StableLeaderShares found;
  std::set<double> samples;
  for (int i = 0; i <= kSamples; ++i) samples.insert(static_cast<double>(i) / kSamples);
  for (const std::size_t type : type_order(model)) {
    const Weights weights(model.types[type].vehicle);
    const std::string& name = model.types[type].name;
    if (!weights.are_shared()) continue;
    if (weights.leader > 0.0 && weights.leader < 1.0) samples.insert(weights.leader);
    if (std::find(found.types.begin(), found.types.end(), name) == found.types.end()) found.types.push_back(name);
  }
  if (found.types.empty()) return std::nullopt;
  const VariedMargins margins =
      varied_margins([&model](double share) { return with_leader_share(model, share); }, *samples.begin());
  found.intervals = margins.intervals({samples.begin(), samples.end()});
  if (!found.intervals.empty() && found.intervals.back().to == 1.0) found.critical = found.intervals.back().from;
  return found;
}

}  // namespace platoon
