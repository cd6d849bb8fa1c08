#include "stochastic_platoon/run/scaling/whole_run.hpp"

#include <system_error>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/simulation/ensemble_run.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"

namespace platoon {

namespace {

RunResult compute_in_memory(const Configuration& configuration, const ShardSettings& settings) {
  const RunOptions& run = configuration.run;
  const double began = now();
  EnsembleRun work(configuration.model, ensemble_of(run), {0, run.realizations});
  StopRequest stop(settings);
  complete(work, settings.threads, [&] {
    settings.progress(work.done());
    stop.obey(work);
  });
  if (settings.stop()) return {};
  const EnsembleTotals totals = work.release();
  return result_of(configuration, totals, {positions_expected(run, totals.count()), 1, now() - began, 0});
}

Prediction prediction_until_stopped(const Configuration& configuration, const ShardSettings& settings) {
  const Interruptible by_settings([&settings] {
    if (settings.stop()) throw Interrupted();
  });
  return predict(configuration);
}

}  // namespace

WholeRun compute_run(Configuration configuration, const ShardSettings& settings) {
  const std::string output = configuration.run.output;
  if (output.empty())
    return {prediction_until_stopped(configuration, settings), compute_in_memory(configuration, settings)};
  // A restarted run keeps its name, so that it takes over its folder and its lock.
  configuration.run.launch_id = "monte_carlo";
  const std::unique_ptr<FolderLock> lock = lock_output(configuration.run);
  WholeRun run{prediction_until_stopped(configuration, settings), {}};
  const ShardResult computed = compute_shard({configuration, {0, 1}}, settings);
  const Checkpoint& found = computed.checkpoint;
  run.result = result_of(configuration, found.totals, found.tally);
  run.unsaved = computed.unsaved;
  if (run.result.realizations == 0 || !run.unsaved.empty()) return run;
  configuration.run.launch_id.clear();
  try {
    write_results(configuration, run.prediction, run.result);
  } catch (const std::system_error& error) {
    run.unsaved = error.what();
    return run;
  }
  if (!run.result.complete) return run;  // its checkpoint stays beside the results
  remove_checkpoints(output);
  return run;
}

}  // namespace platoon
