#include "stochastic_platoon/run/results/run_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace platoon {

namespace {

// Each launch numbers its attempts anew, but not in an endless run, where each attempt is another realization.
Tally tally_of(const std::optional<Checkpoint>& start, const RunOptions& run) {
  if (!start) return {};
  Tally tally = start->tally;
  if (start->launch_id != run.launch_id && run.averaging() == Averaging::over_realizations) tally.attempts = 0;
  return tally;
}

EarlierAverages averages_of(const std::optional<Checkpoint>& start) {
  if (!start) return {};
  return {&start->table, start->time_averages};
}

}  // namespace

RunStatistics::RunStatistics(const Configuration& configuration, const std::optional<Checkpoint>& start)
    : RunStatistics(configuration, start ? start->table.count() : 0, tally_of(start, configuration.run),
                    averages_of(start)) {}

RunStatistics::RunStatistics(const Configuration& configuration, std::uint64_t first_realization)
    : RunStatistics(configuration, first_realization, Tally{}, EarlierAverages{}) {}

RunStatistics::RunStatistics(const Configuration& configuration, std::uint64_t first_realization, const Tally& start,
                             const EarlierAverages& earlier)
    : configuration_(configuration),
      kept_(has_normal_errors(configuration.model) ? KeptMoments::two : KeptMoments::four),
      tally_(start),
      averages_(error_averages(configuration.run.followers, configuration.run.steps, configuration.run.burn_in, earlier,
                               kept_)),
      assembly_(configuration.run.schedule(), configuration.run.followers, first_realization, start.attempts) {
  for (std::size_t i = 1; i <= configuration.run.followers; ++i)
    error_.push_back(tracking_error(configuration.model, i));
  if (configuration.run.averaging() == Averaging::over_realizations) return;
  leader_.emplace(ModelLeader{LeaderVehicle(configuration.model), 0.0});
  averages_->saw_leader(kNothingYet, true);
}

RunStatistics::Receipt RunStatistics::receive(std::size_t vehicle, const MessageDescriptor& descriptor,
                                              const Positions& positions) {
  ErrorAssembly::Receipt receipt = assembly_.receive(vehicle, descriptor, positions);
  if (receipt.restarted) averages_->restart();
  if (leader_ && vehicle == 0 && receipt.drop == DropReason::none)
    compare_leader(descriptor.id.step, positions->front());
  if (receipt.drop == DropReason::none) tally_.attempts = std::max(tally_.attempts, descriptor.id.attempt);
  return {receipt.drop, {vehicle, descriptor, std::move(receipt.due)}};
}

// Compares the movement in one step, as a finished manoeuvre leaves the leader displaced.
void RunStatistics::compare_leader(std::int64_t step, double position) {
  constexpr double kSame = 1e-6;  // [m] per step: above any rounding, and far below any noise
  const double ahead = position - (step == kInitialStep ? leader_->vehicle.start() : leader_->vehicle.step());
  leader_departs_ = step != kInitialStep && !(std::abs(ahead - leader_->ahead) <= kSame);
  leader_->ahead = ahead;
  averages_->saw_leader(step, !leader_departs_);
}

// The errors are formed tile by tile, so that each tile is reduced while it is in the first level cache.
ReducedErrors RunStatistics::reduced(const DueErrors& due) const {
  const std::size_t count = due.own->size();
  const auto errors = [this, &due](std::size_t offset, std::size_t size, double* buffer) {
    error_[due.follower - 1](due.predecessor->data() + offset, due.own->data() + offset,
                             due.own_before->data() + offset, size, buffer);
    return static_cast<const double*>(buffer);
  };
  return {due.follower, due.id.step, due.id.first_realization, count,
          reduce_batch(due.id.first_realization, count, errors, kept_)};
}

RunStatistics::Computed RunStatistics::compute(const Work& work) const {
  Computed computed{work.vehicle, work.descriptor, {}};
  computed.errors.reserve(work.due.size());
  for (const DueErrors& due : work.due) computed.errors.push_back(reduced(due));
  return computed;
}

bool RunStatistics::settle(const Computed& computed) {
  if (computed.descriptor.id.attempt < arrivals().attempt()) return false;  // a newer attempt has begun
  for (const ReducedErrors& errors : computed.errors) averages_->add(errors);
  const std::optional<CompleteBatch> batch = assembly_.settle(computed.vehicle, computed.descriptor);
  if (averages_->averaging() == Averaging::over_time) tally_.positions_received += computed.descriptor.size;
  if (!batch) return false;
  averages_->commit(batch->first_realization);
  tally_.positions_received += batch->positions_received;
  return true;
}

DropReason RunStatistics::take(std::size_t vehicle, const MessageDescriptor& descriptor, const Positions& positions) {
  const Receipt receipt = receive(vehicle, descriptor, positions);
  if (receipt.drop == DropReason::none) settle(compute(receipt.work));
  return receipt.drop;
}

void RunStatistics::saw(std::uint64_t platoon_time) {
  tally_.platoon_time = std::max(tally_.platoon_time, platoon_time);
}

RunResult RunStatistics::result(bool complete) const {
  RunResult result{complete,
                   averages_->realizations(),
                   std::max<std::int64_t>(averages_->last_step(), 0),
                   tally_,
                   averages_->moments(),
                   {},
                   averages_->counted_from(),
                   leader_departs_,
                   averages_->shares()};
  for (std::size_t i = 1; i <= configuration_.run.followers; ++i) result.last_steps.push_back(averages_->last_step(i));
  return result;
}

Checkpoint RunStatistics::checkpoint() const {
  Checkpoint checkpoint{statistics_identity(configuration_), configuration_.run.launch_id, tally_, MomentTable(0)};
  if (const MomentTable* totals = averages_->totals()) {
    checkpoint.table = *totals;
  } else {
    checkpoint.time_averages = averages_->moments();
  }
  return checkpoint;
}

}  // namespace platoon
