#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/amplification.hpp"
#include "stochastic_platoon/math/string/collision_risk.hpp"

namespace platoon {

/// The signals to analyse beside the tracking error.
struct SignalRequest {
  std::vector<std::string> names;                    ///< as signal_names() returns them
  std::optional<double> collision_probability = {};  ///< per step, in (0, 1/2), to find the standstill distance for
  std::int64_t burn_in = 0;                          ///< first step of amplification()

  /// The names, with the gap if collisions are requested.
  std::vector<std::string> all_names() const;
};

/// Reads a request from texts: names separated by commas, and a number or nothing. Throws ConfigurationError with all
/// problems.
SignalRequest signal_request(const std::string& names, const std::string& collision_probability);

/// The theory of the requested signals. Empty if errors are not normal.
struct SignalAnalysis {
  SignalRequest request;
  std::size_t steps = 0;
  std::vector<SignalMoments> moments;  ///< in the order of request.all_names(), as is `stationary`
  std::vector<StationarySignal> stationary;
  std::optional<CollisionRisk> collisions;
  std::vector<Amplification> amplification = {};  ///< one per vehicle 0 .. N; empty without the speed

  bool is_empty() const { return moments.empty(); }
};

/// `begins` receives the name of each stage before it is computed. `string_stable`: the verdict of string_stability().
SignalAnalysis analyze_signals(const PlatoonModel& model, const SignalRequest& request, std::size_t followers,
                               std::int64_t steps, bool string_stable,
                               const std::function<void(const char* stage)>& begins);

/// "largest 1.158 of follower 3, head to tail 18.88": the L2 ratios of the speeds; empty if there are none.
std::string largest_and_tail(const std::vector<Amplification>& of);

/// The report's line for a leader at constant speed from this step on.
std::string no_amplification(std::int64_t from);

/// A line for each signal and for the amplification, three for the collisions; one line if there is no theory.
std::string report(const PlatoonModel& model, const SignalAnalysis& analysis);

/// Adds the keys `signals`, `collision` and `amplification` as far as they are requested; null if there is no theory.
void add_to_json(const SignalAnalysis& analysis, nlohmann::json& document);

}  // namespace platoon
