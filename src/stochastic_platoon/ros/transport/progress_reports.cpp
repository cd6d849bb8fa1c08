#include "stochastic_platoon/ros/transport/progress_reports.hpp"

#include <algorithm>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

using stochastic_platoon::Progress;

ProgressReports::ProgressReports(ros::NodeHandle platoon, const std::string& receiver,
                                 const Configuration& configuration)
    : pace_(configuration.run.schedule(), configuration.run.window),
      publisher_(platoon.advertise<Progress>(kProgressTopic, kUnboundedQueue)) {
  message_.receiver = receiver;
  message_.run = run_identity(configuration);
}

void ProgressReports::saw(std::uint64_t platoon_time) {
  message_.header.stamp = std::max(message_.header.stamp, platoon::platoon_time(platoon_time));
}

void ProgressReports::report_if_due(const Arrivals& arrivals) {
  if (pace_.is_due(arrivals.acknowledgement())) report(arrivals);
}

void ProgressReports::report(const Arrivals& arrivals) {
  const Acknowledgement present = arrivals.acknowledgement();
  pace_.note_report(present);
  message_.attempt = present.attempt;
  message_.first_realization = present.first_realization;
  message_.step = present.step;
  message_.messages = arrivals.messages();
  publisher_.publish(message_);
}

}  // namespace platoon
