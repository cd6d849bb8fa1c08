#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <future>
#include <optional>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Publishes a run's statistics beside their theory: error_statistics (stochastic_platoon/ErrorStatistics, about once a
/// second, latched), overview (stochastic_platoon/Overview, latched), configuration (std_msgs/String, latched: model
/// and run as JSON). Uses no clock: times are arguments [s].
class StatisticsPublisher {
public:
  /// Publishes configuration and theory at once.
  StatisticsPublisher(ros::NodeHandle platoon, const Configuration& configuration, const Prediction& prediction,
                      std::uint64_t run);

  bool is_due(double now) const;

  /// Publishes the latest step, and the overview if it has subscribers.
  void publish(const RunResult& result, double now);

  /// Publishes all steps of a complete run.
  void publish_complete(const RunResult& result);

private:
  void publish_step(const ResultCells& cells, std::int64_t step, const RunResult& result);
  void publish_overview(const RunResult& result);

  RunOptions run_;
  const Prediction& prediction_;
  std::uint64_t identity_;
  std::shared_future<std::vector<double>> headways_;  ///< slow; for endless runs only: change_run may follow
  std::optional<double> latest_;                      ///< [s]
  ros::Publisher error_statistics_;
  ros::Publisher overview_;       ///< latched: late subscribers get the overview of a complete run
  ros::Publisher configuration_;  ///< latched: a recording contains it
};

}  // namespace platoon
