#include "stochastic_platoon/ros/observation/statistics_publisher.hpp"

#include <std_msgs/String.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Overview.h>

#include <algorithm>
#include <chrono>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/observation/overview.hpp"
#include "stochastic_platoon/ros/transport/kept_topics.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Overview;

namespace {

constexpr double kPeriod = 1.0;  // [s] for an ensemble; an endless run publishes with every heartbeat

// [from, to, from, to, ...]; empty if there are none or none are known.
std::vector<double> flat_stable_headways(const PlatoonModel& model) {
  std::vector<double> flat;
  if (no_theory(model)) return flat;
  if (const std::optional<StableHeadways> headways = stable_headways(model)) {
    for (const HeadwayInterval& of : headways->intervals) flat.insert(flat.end(), {of.from, of.to});
  }
  return flat;
}

bool is_endless(const RunOptions& run) {
  return run.averaging() == Averaging::over_time;
}

}  // namespace

StatisticsPublisher::StatisticsPublisher(ros::NodeHandle platoon, const Configuration& configuration,
                                         const Prediction& prediction, std::uint64_t run)
    : run_(configuration.run),
      prediction_(prediction),
      identity_(run),
      error_statistics_(advertise_kept<ErrorStatistics>(
          platoon, kErrorStatisticsTopic, static_cast<std::uint32_t>(std::max<std::int64_t>(1000, run_.steps)), true)),
      overview_(advertise_kept<Overview>(platoon, kOverviewTopic, 1, true)),
      configuration_(advertise_kept<std_msgs::String>(platoon, kConfigurationTopic, 1, true)) {
  std_msgs::String text;
  text.data = to_json(configuration).dump();
  configuration_.publish(text);
  if (is_endless(run_)) headways_ = std::async(std::launch::async, flat_stable_headways, configuration.model).share();
  publish_overview({});  // the theory need not wait for the first figures
}

bool StatisticsPublisher::is_due(double now) const {
  return is_endless(run_) || !latest_ || now - *latest_ >= kPeriod;
}

void StatisticsPublisher::publish(const RunResult& result, double now) {
  latest_ = now;
  publish_step(ResultCells(run_, prediction_, result), result.last_step, result);
  if (overview_.getNumSubscribers() > 0) publish_overview(result);
}

void StatisticsPublisher::publish_complete(const RunResult& result) {
  const ResultCells cells(run_, prediction_, result);
  for (std::int64_t k = 0; k < run_.steps; ++k) publish_step(cells, k, result);
  publish_overview(result);
}

void StatisticsPublisher::publish_step(const ResultCells& cells, std::int64_t step, const RunResult& result) {
  ErrorStatistics message;
  message.header.stamp = platoon_time(result.tally.platoon_time);
  message.step = step;
  message.realizations = result.realizations;
  message.time_average = is_endless(run_);
  for (const ResultCell& of : cells.at(step)) {
    message.mean.push_back(of.measured.mean);
    message.variance.push_back(of.measured.variance());
    message.theoretical_mean.push_back(of.theoretical_mean);
    message.theoretical_variance.push_back(of.theoretical_variance);
  }
  error_statistics_.publish(message);
}

void StatisticsPublisher::publish_overview(const RunResult& result) {
  Overview message = overview_of(run_, prediction_, result);
  message.run = identity_;
  if (headways_.valid() && headways_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    message.stable_headways = headways_.get();
  overview_.publish(message);
}

}  // namespace platoon
