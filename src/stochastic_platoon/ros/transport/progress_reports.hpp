#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Progress.h>

#include <cstdint>
#include <functional>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/arrivals.hpp"
#include "stochastic_platoon/run/delivery/report_pace.hpp"

namespace platoon {

constexpr double kHeartbeat = 0.05;  ///< [s] between reports if none is due earlier

/// A receiver's reports on topic progress, which give the leader its credit.
///
/// The first report waits until all publishers are connected, so that no attempt is wasted.
class ProgressReports {
public:
  ProgressReports(ros::NodeHandle platoon, const std::string& receiver, const Configuration& configuration);

  /// Whether all of the receiver's topics are connected, or once were; `connected` is called until they are.
  bool is_linked(const std::function<bool()>& connected) { return linked_ = linked_ || connected(); }

  /// Reports carry the latest platoon time seen [ns].
  void saw(std::uint64_t platoon_time);

  /// Reports the arrivals, if a report is due.
  void report_if_due(const Arrivals& arrivals);

  void report(const Arrivals& arrivals);

  void set_finished() { message_.finished = true; }
  /// A text for the progress display.
  void set_note(const std::string& note) { set_notice(stochastic_platoon::Progress::NONE, note); }
  /// Reports that the receiver is blocked, with the reason.
  void set_blocked(const std::string& reason) { set_notice(stochastic_platoon::Progress::BLOCKED, reason); }

private:
  void set_notice(std::uint8_t notice, const std::string& note) {
    message_.notice = notice;
    message_.note = note;
  }

  ReportPace pace_;
  bool linked_ = false;
  stochastic_platoon::Progress message_;
  ros::Publisher publisher_;
};

}  // namespace platoon
