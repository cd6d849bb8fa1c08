#include "stochastic_platoon/results/run_statistics.hpp"

#include <algorithm>

namespace platoon {

RunStatistics::RunStatistics(const Configuration& configuration, const std::optional<Checkpoint>& start,
                             const Arithmetic& arithmetic)
    : RunStatistics(configuration, start ? start->table.count() : 0, start ? start->tally : Tally{},
                    arithmetic) {
  if (start) ensemble_.merge(start->table);
}

RunStatistics::RunStatistics(const Configuration& configuration, std::uint64_t first_realization)
    : RunStatistics(configuration, first_realization, Tally{}, do_at_once) {}

RunStatistics::RunStatistics(const Configuration& configuration, std::uint64_t first_realization,
                             const Tally& start, const Arithmetic& arithmetic)
    : tally(start),
      configuration_(configuration),
      ensemble_(configuration.run.followers, configuration.run.steps),
      time_averages_(configuration.run.followers, configuration.run.burn_in),
      assembly_(configuration.run.schedule(), configuration.run.followers,
                {configuration.model.headway, configuration.model.standstill_distance}, first_realization,
                start.attempts,
                {[this](std::size_t follower, const Turn& turn, const auto& errors) {
                   take_errors(follower, turn, errors);
                 },
                 [this](const CompleteBatch& batch) {
                   ensemble_.commit(batch.first_realization);
                   tally.positions_received += batch.positions_received;
                 },
                 [this] { restart(); }, configuration.run.steps == 0 ? do_at_once : arithmetic}) {}

Verdict RunStatistics::receive(std::size_t vehicle, const Turn& turn, const Positions& positions) {
  const Verdict verdict = assembly_.receive(vehicle, turn, positions);
  if (verdict != Verdict::in_turn) return verdict;
  tally.attempts = std::max(tally.attempts, turn.attempt);
  if (endless()) tally.positions_received += positions->size();
  return verdict;
}

void RunStatistics::take_errors(std::size_t follower, const Turn& turn, const std::vector<double>& errors) {
  if (!endless()) return ensemble_.add(follower, turn.step, turn.first_realization, errors);
  time_averages_.add(follower, turn.step, errors.front());
  last_step_ = std::max(last_step_, turn.step);
}

void RunStatistics::restart() {
  ensemble_.discard_open();
  time_averages_.restart();
  last_step_ = kNothingYet;
  if (endless()) tally.positions_received = 0;
}

std::vector<Moments> RunStatistics::moments() const {
  return endless() ? time_averages_.moments() : ensemble_.committed().totals();
}

RunResult RunStatistics::result(bool complete) const {
  return {complete, realizations(), std::max<std::int64_t>(last_step(), 0), tally, moments()};
}

Checkpoint RunStatistics::checkpoint() const {
  return {statistics_identity(configuration_), configuration_.run.launch, tally, ensemble_.committed()};
}

}  // namespace platoon
