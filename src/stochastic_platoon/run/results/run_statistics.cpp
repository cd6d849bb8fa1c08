#include "stochastic_platoon/run/results/run_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"
#include "stochastic_platoon/math/statistics/signal_reduction.hpp"
#include "stochastic_platoon/math/statistics/time_statistics.hpp"

namespace platoon {

namespace {

// Each launch numbers its attempts anew, but not in an endless run, where each attempt is another realization.
Tally tally_of(const Checkpoint* start, const RunOptions& run) {
  if (start == nullptr) return {};
  Tally tally = start->tally;
  if (start->launch_id != run.launch_id && run.averaging() == Averaging::over_realizations) tally.attempts = 0;
  return tally;
}

// Averages over time in an endless run, of its errors alone; otherwise over realizations. They continue `start`.
std::unique_ptr<ErrorAverages> averages_of(const Configuration& configuration, const SignalCells& cells,
                                           const Checkpoint* start) {
  const RunOptions& run = configuration.run;
  if (run.averaging() == Averaging::over_time)
    return std::make_unique<TimeStatistics>(
        run.followers, run.burn_in, start ? start->time_averages : std::vector<Moments>(),
        steps_from_leader(configuration.model, run.followers), has_limits(configuration.model));
  auto averages = std::make_unique<EnsembleStatistics>(cells);
  if (start != nullptr) averages->merge(start->totals);
  return averages;
}

}  // namespace

RunStatistics::RunStatistics(const Configuration& configuration, const std::optional<Checkpoint>& start)
    : RunStatistics(configuration, start ? &*start : nullptr, start ? start->totals.count() : 0) {}

RunStatistics::RunStatistics(const Configuration& configuration, std::uint64_t first_realization)
    : RunStatistics(configuration, nullptr, first_realization) {}

RunStatistics::RunStatistics(const Configuration& configuration, const Checkpoint* start,
                             std::uint64_t first_realization)
    : configuration_(configuration),
      cells_(cells_of(configuration)),
      signals_(signals_of_all(configuration.model, configuration.run.signals, configuration.run.followers)),
      tally_(tally_of(start, configuration.run)),
      averages_(averages_of(configuration, cells_, start)),
      assembly_(configuration.run.schedule(), configuration.run.followers, first_realization, tally_.attempts,
                static_cast<std::int64_t>(steps_before(signals_.front())), start_slope(configuration.model),
                measured_followers(configuration)) {
  if (configuration.run.averaging() == Averaging::over_realizations) return;
  leader_.emplace(ModelLeader{LeaderVehicle(configuration.model), 0.0, false});
  averages_->saw_leader(kNothingYet, true);
}

SignalAssembly::Receipt RunStatistics::receive(std::size_t vehicle, const MessageDescriptor& descriptor,
                                               const Positions& positions) {
  SignalAssembly::Receipt receipt = assembly_.receive(vehicle, descriptor, positions);
  if (receipt.restarted) averages_->restart();
  if (leader_ && vehicle == 0 && receipt.drop == DropReason::none)
    compare_leader(descriptor.id.step, positions->front());
  if (receipt.drop == DropReason::none) tally_.attempts = std::max(tally_.attempts, descriptor.id.attempt);
  return receipt;
}

// Compares the movement in one step, as a finished manoeuvre leaves the leader displaced.
void RunStatistics::compare_leader(std::int64_t step, double position) {
  constexpr double kSame = 1e-6;  // [m] per step: above any rounding, and far below any noise
  const double ahead = position - (step == kInitialStep ? leader_->vehicle.start() : leader_->vehicle.step());
  const bool departs = step != kInitialStep && !(std::abs(ahead - leader_->ahead) <= kSame);
  leader_departs_ = departs || (step != kInitialStep && leader_->departed);
  leader_->departed = departs;
  leader_->ahead = ahead;
  averages_->saw_leader(step, !departs);
}

ReducedSignals RunStatistics::reduced(const DueSignals& due) const {
  const std::size_t count = due.own.front()->size();
  SignalPositions positions{{}, {}, count};
  if (due.input) positions.input = due.input->data();
  for (std::size_t j = 0; j < due.own.size() && due.own[j] != nullptr; ++j) {
    positions.ahead[j] = due.ahead[j]->data();
    positions.own[j] = due.own[j]->data();
  }
  const FollowerSignals& signals = signals_[due.follower - 1];
  ReducedSignals reduced{due.follower,
                         due.id.step,
                         due.id.first_realization,
                         count,
                         {reduce_signal(due.id.first_realization, signals.error, positions, cells_.kept)}};
  if (!cells_.limits.empty()) reduced.at_limits = count_at_limits(cells_.limits[due.follower - 1], positions);
  if (signals.requested.empty()) return reduced;
  FormedValues values;
  if (cells_.has_gap()) {
    reduced.gaps.assign(count, std::numeric_limits<double>::infinity());
    values.smallest = reduced.gaps.data();
  }
  SignalReduction reduction(due.id.first_realization, count, cells_.kept);
  for (const std::vector<MomentNode>& nodes : reduction.reduce(signals, positions, values))
    reduced.nodes.push_back(nodes);
  return reduced;
}

std::vector<ReducedSignals> RunStatistics::compute(const std::vector<DueSignals>& due) const {
  std::vector<ReducedSignals> signals;
  signals.reserve(due.size());
  for (const DueSignals& of : due) signals.push_back(reduced(of));
  return signals;
}

bool RunStatistics::settle(std::size_t vehicle, const MessageDescriptor& descriptor,
                           const std::vector<ReducedSignals>& signals) {
  if (descriptor.id.attempt < arrivals().attempt()) return false;  // a newer attempt has begun
  for (const ReducedSignals& of : signals) averages_->add(of);
  const std::optional<CompleteBatch> batch = assembly_.settle(vehicle, descriptor);
  if (configuration_.run.averaging() == Averaging::over_time) tally_.positions_received += descriptor.size;
  if (!batch) return false;
  averages_->commit(batch->first_realization);
  const std::size_t vehicles = configuration_.run.followers + 1;  // their streams and those of inputs are of one length
  tally_.positions_received += batch->positions_received / (vehicles + measured().size()) * vehicles;
  return true;
}

DropReason RunStatistics::take(std::size_t vehicle, const MessageDescriptor& descriptor, const Positions& positions) {
  const SignalAssembly::Receipt receipt = receive(vehicle, descriptor, positions);
  if (receipt.drop == DropReason::none) settle(vehicle, descriptor, compute(receipt.due));
  return receipt.drop;
}

void RunStatistics::saw(std::uint64_t platoon_time) {
  tally_.platoon_time = std::max(tally_.platoon_time, platoon_time);
}

RunResult RunStatistics::result(bool complete) const {
  RunResult result;
  if (const EnsembleTotals* totals = averages_->totals()) {
    result = result_of(configuration_, *totals);
  } else {
    result.realizations = averages_->realizations();
    result.moments = averages_->moments();
  }
  result.complete = complete;
  std::int64_t reached = averages_->last_step(1);
  for (std::size_t i = 1; i <= configuration_.run.followers; ++i) {
    reached = std::min(reached, averages_->last_step(i));
    result.last_steps.push_back(averages_->last_counted(i));
  }
  result.last_step = std::max<std::int64_t>(reached, 0);
  result.tally = tally_;
  result.counted_from = averages_->counted_from();
  result.manoeuvre = leader_departs_;
  result.provisional = averages_->provisional();
  result.shares = averages_->shares();
  return result;
}

Checkpoint RunStatistics::checkpoint() const {
  Checkpoint checkpoint{statistics_identity(configuration_), configuration_.run.launch_id, tally_, {}};
  if (const EnsembleTotals* totals = averages_->totals()) {
    checkpoint.totals = *totals;
  } else {
    checkpoint.time_averages = averages_->moments();
  }
  return checkpoint;
}

}  // namespace platoon
