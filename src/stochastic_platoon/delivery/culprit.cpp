#include "stochastic_platoon/delivery/culprit.hpp"

#include <tuple>

namespace platoon {

namespace {

// What a follower can have sent once its predecessor has sent `turn`: the step after it, or the end of the
// batch.
Turn reachable(const Turn& turn, const BatchSchedule& schedule) {
  return schedule.is_last_step(turn.step) ? turn : Turn{turn.attempt, turn.first_realization, turn.step + 1};
}

bool is_behind(const std::optional<Turn>& own, const Turn& reachable_turn) {
  if (!own) return true;
  return std::tie(own->first_realization, own->step) <
         std::tie(reachable_turn.first_realization, reachable_turn.step);
}

std::string silence(const std::string& name, const std::optional<Turn>& latest) {
  if (!latest) return name + " has sent nothing at all";
  return name + " has sent nothing since step " + std::to_string(latest->step) + " (realizations from " +
         std::to_string(latest->first_realization) + ")";
}

}  // namespace

std::string culprit(const std::vector<std::optional<Turn>>& latest, const BatchSchedule& schedule) {
  std::vector<std::size_t> stuck;
  for (std::size_t i = 1; i < latest.size(); ++i) {
    if (latest[i - 1] && is_behind(latest[i], reachable(*latest[i - 1], schedule))) stuck.push_back(i);
  }
  if (stuck.empty()) return silence("vehicle_0 (leader)", latest.front());
  const std::string first = silence("vehicle_" + std::to_string(stuck.front()), latest[stuck.front()]);
  if (stuck.size() == 1) return first + (latest.size() == 2 ? ": it or the channel is down" : "");
  if (stuck.size() + 1 == latest.size()) {
    return "channel has passed nothing on: all followers wait, " + first;
  }
  return first + "; the same holds for " + std::to_string(stuck.size() - 1) + " more";
}

}  // namespace platoon
