#include "stochastic_platoon/run/results/run_store.hpp"

#include <stdexcept>
#include <utility>

#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"

namespace platoon {

namespace {

constexpr double kCheckpointPeriod = 1.0;  // [s]

}  // namespace

RunStore::RunStore(const Configuration& configuration, RetriedWrite::Log failed, RetriedWrite::Log recovered)
    : configuration_(configuration),
      lock_(lock_output(configuration.run)),
      write_(
          [failed = std::move(failed), output = configuration.run.output](const std::string& error) {
            failed(error + "; " + free_space(checkpoint_file(output)) +
                   ". Retrying until there is space; the run continues");
          },
          [recovered = std::move(recovered), output = configuration.run.output] {
            recovered(output + ": can be written again");
          }) {
  ignore_file_size_signal();
}

std::optional<Checkpoint> RunStore::start(const RetriedWrite::Log& damaged) {
  std::optional<Checkpoint> found = starting_point(configuration_);
  if (!found) return found;
  if (!found->damage.empty()) damaged(found->damage + ": going on from the one before it, of " + extent_of(*found));
  saved_ = found->tally.positions_received;
  return found;
}

bool RunStore::can_write(double now) const {
  return write_.is_due(now);
}

bool RunStore::is_due(std::uint64_t positions, double now) const {
  return positions > saved_ && !(latest_ && now - *latest_ < kCheckpointPeriod) && write_.is_due(now);
}

void RunStore::save(const Checkpoint& checkpoint, double now) {
  if (!write_(now, [&] { write_checkpoint(configuration_.run.output, checkpoint); })) return;
  saved_ = checkpoint.tally.positions_received;
  latest_ = now;
}

bool RunStore::complete(const Checkpoint& checkpoint, const Prediction& prediction, const RunResult& result,
                        double now) {
  return write_(now, [&] {
    write_checkpoint(configuration_.run.output, checkpoint);
    write_results(configuration_, prediction, result);
  });
}

std::string RunStore::stop(const Checkpoint& checkpoint, const Prediction& prediction, const RunResult& result) {
  try {
    if (checkpoint.tally.positions_received > saved_) write_checkpoint(configuration_.run.output, checkpoint);
    write_results(configuration_, prediction, result);
    return "";
  } catch (const std::runtime_error& error) {
    return std::string(error.what()) + "; " + free_space(checkpoint_file(configuration_.run.output));
  }
}

}  // namespace platoon
