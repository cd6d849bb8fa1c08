#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <stochastic_platoon/Progress.h>

#include <cstdint>
#include <string>
#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/delivery/arrivals.hpp"
#include "stochastic_platoon/delivery/report_pace.hpp"

namespace platoon {

/// A vehicle's note that begins so says which attempt it cannot follow, a receiver's why the platoon stands still.
constexpr char kMissed[] = "has missed messages of attempt ";
constexpr char kHoldsUp[] = "holds the platoon up: ";

constexpr double kHeartbeat = 0.05;  ///< [s] between reports when nothing else calls for one

/// A receiver's reports on topic progress: what the leader's credit lives on.
///
/// The first report waits until every publisher can be heard, so that no attempt is wasted before.
class ProgressReports {
public:
  ProgressReports(ros::NodeHandle platoon, const std::string& receiver, const Configuration& configuration);

  /// Whether every one of these has a publisher, or once had.
  bool is_linked(const std::vector<ros::Subscriber>& subscribers);

  /// Reports carry the latest platoon time seen [ns].
  void saw(std::uint64_t platoon_time);

  /// Reports what has arrived, if a report is due.
  void report_if_due(const Arrivals& arrivals);

  void report(const Arrivals& arrivals);

  void set_finished() { message_.finished = true; }
  void set_note(const std::string& note) { message_.note = note; }

private:
  ReportPace pace_;
  bool linked_ = false;
  stochastic_platoon::Progress message_;
  ros::Publisher publisher_;
};

}  // namespace platoon
