#include "stochastic_platoon/run/delivery/stall_diagnosis.hpp"

#include <algorithm>
#include <tuple>

#include "stochastic_platoon/run/delivery/pipeline.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

namespace {

// The latest message that a follower can have sent after its predecessor sent `id`: the same step or, if it publishes
// ahead, the next one, up to the end of the batch.
MessageId reachable(const MessageId& id, bool ahead, const BatchSchedule& schedule) {
  if (!ahead || schedule.is_last_step(id.step)) return id;
  return {id.attempt, id.first_realization, id.step + 1};
}

bool is_behind(const std::optional<MessageId>& own, const MessageId& reachable_id) {
  if (!own) return true;
  return std::tie(own->first_realization, own->step) < std::tie(reachable_id.first_realization, reachable_id.step);
}

std::string silence(const std::string& name, const std::optional<MessageId>& latest) {
  if (!latest) return name + " has sent nothing at all";
  return name + " has sent nothing since step " + std::to_string(latest->step) + " (realizations from " +
         std::to_string(latest->first_realization) + ")";
}

}  // namespace

StallDiagnosis diagnose_stall(const std::vector<std::optional<MessageId>>& latest, const BatchSchedule& schedule,
                              std::size_t pipeline_depth, const std::vector<std::size_t>& external,
                              const std::vector<std::optional<MessageId>>& ever) {
  const auto silence_of = [&latest, &ever](std::size_t vehicle, const std::string& name) {
    return silence(name, latest[vehicle] || ever.empty() ? latest[vehicle] : ever[vehicle]);
  };
  std::vector<std::size_t> stuck;
  const std::size_t followers = latest.size() - 1;
  for (std::size_t i = 1; i <= followers; ++i) {
    const bool ahead =
        publishes_ahead(i, followers, pipeline_depth) && !std::binary_search(external.begin(), external.end(), i);
    if (latest[i - 1] && is_behind(latest[i], reachable(*latest[i - 1], ahead, schedule))) stuck.push_back(i);
  }
  if (stuck.empty()) return {StallCause::silent_vehicle, 0, silence_of(0, "vehicle_0 (leader)")};
  const std::string first = silence_of(stuck.front(), vehicle_name(stuck.front()));
  if (stuck.size() > 1 && stuck.size() == followers)
    return {StallCause::silent_channel, std::nullopt, "channel has passed nothing on: all followers wait, " + first};
  const std::string others =
      stuck.size() > 1 ? "; the same holds for " + std::to_string(stuck.size() - 1) + " more" : std::string();
  return {StallCause::silent_vehicle, stuck.front(),
          first + (followers == 1 ? ": it or the channel is down" : "") + others};
}

}  // namespace platoon
