#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/run/configuration/run_options.hpp"
#include "stochastic_platoon/run/delivery/arrivals.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"
#include "stochastic_platoon/run/delivery/stall_diagnosis.hpp"
#include "stochastic_platoon/run/delivery/stall_watch.hpp"

namespace platoon {

/// Detects a stalled run and names the node that blocks it. Uses neither clock nor topic; times are arguments [s].
class StallReporter {
public:
  /// A notice of another component: `kind` is one of stochastic_platoon::Progress.
  struct Notice {
    std::uint8_t kind;
    std::uint32_t attempt;
    std::string text;
  };

  /// The state of the platoon as the monitor sees it.
  struct Observation {
    const Arrivals& arrivals;
    bool began;  ///< the first step is complete
    /// Vehicles without a publisher, ascending. Called during a stall only.
    std::function<std::vector<std::size_t>()> missing;
    /// The latest contract violation of an external vehicle. Called during a stall only.
    std::function<std::optional<DropReason>(std::size_t vehicle)> breach;
    /// Vehicles, ascending, that do not publish the control input that their follower expects by radio. Called during a
    /// stall only.
    std::function<std::vector<std::size_t>()> mute;
  };

  /// Empty strings: nothing to log.
  struct Change {
    std::string stalled;  ///< the reason; also when another cause or vehicle is found
    std::string moving;   ///< ", after 3.1 s and 2 retries"
  };

  /// `topics`: the resolved name of each vehicle's topic.
  StallReporter(RunOptions run, std::vector<std::string> topics) : run_(std::move(run)), topics_(std::move(topics)) {}

  void receive(const std::string& component, Notice notice);

  /// The text of a component's latest notice; empty without one.
  std::string text_of(const std::string& component) const;

  /// A message has arrived and counts.
  void note_arrival(const Arrivals& arrivals, double present);

  Change look(const Observation& seen, double present);

  bool stalled() const { return watch_.stalled(); }

  /// The reason of the present stall, empty while the platoon moves, and the attempts since it began.
  std::string culprit() const { return culprit_ ? culprit_->text : ""; }
  std::uint32_t retries(const Arrivals& arrivals) const { return arrivals.attempt() - first_attempt_; }

  /// The state of a run whose first step is not complete.
  std::string start(const std::vector<std::size_t>& missing, const Arrivals& arrivals) const;

private:
  StallDiagnosis diagnose(const Observation& seen) const;
  StallDiagnosis of_missing(const std::vector<std::size_t>& missing) const;
  StallDiagnosis of_mute(std::size_t vehicle) const;
  std::optional<StallDiagnosis> of_receivers(const Arrivals& arrivals) const;
  std::string explanation_of(std::size_t vehicle, const Arrivals& arrivals) const;
  std::string breach_of(std::size_t vehicle, const Observation& seen) const;

  RunOptions run_;
  std::vector<std::string> topics_;
  std::map<std::string, Notice> notices_;  ///< the latest of each component
  StallWatch watch_;
  std::optional<StallDiagnosis> culprit_;
  double since_ = 0.0;                           ///< [s] of the present stall
  std::uint32_t first_attempt_ = 0;              ///< of the present stall
  double last_message_ = 0.0;                    ///< [s]
  std::uint64_t most_messages_ = 0;              ///< of an attempt, since the latest complete step
  Acknowledgement complete_{0, 0, kNothingYet};  ///< latest step that has arrived from all vehicles
};

}  // namespace platoon
