#include "stochastic_platoon/graph/progress_reports.hpp"

#include <algorithm>

#include "stochastic_platoon/graph/wire.hpp"

namespace platoon {

using stochastic_platoon::Progress;

ProgressReports::ProgressReports(ros::NodeHandle platoon, const std::string& receiver, const RunOptions& run)
    : pace_(run.schedule(), run.window),
      publisher_(platoon.advertise<Progress>("progress", kUnboundedQueue)) {
  message_.receiver = receiver;
}

bool ProgressReports::is_linked(const std::vector<ros::Subscriber>& subscribers) {
  linked_ = linked_ ||
            std::all_of(subscribers.begin(), subscribers.end(),
                        [](const ros::Subscriber& subscriber) { return subscriber.getNumPublishers() > 0; });
  return linked_;
}

void ProgressReports::saw(std::uint64_t platoon_time) {
  message_.header.stamp = std::max(message_.header.stamp, ros::Time().fromNSec(platoon_time));
}

void ProgressReports::report_if_due(const Acknowledgement& present) {
  if (pace_.is_due(present)) report(present);
}

void ProgressReports::report(const Acknowledgement& present) {
  pace_.note_report(present);
  message_.attempt = present.attempt;
  message_.first_realization = present.first_realization;
  message_.step = present.step;
  publisher_.publish(message_);
}

}  // namespace platoon
