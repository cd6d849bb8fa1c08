#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/amplification.hpp"
#include "stochastic_platoon/math/string/collision_risk.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The signals to analyse beside the tracking error.
struct SignalRequest {
  std::vector<std::string> names;                    ///< as signal_names() returns them
  std::optional<double> collision_probability = {};  ///< per step, in (0, 1/2), to find the standstill distance for

  /// The names, with the gap if collisions are requested.
  std::vector<std::string> all_names() const;
};

/// Reads a request from texts: names separated by commas, and a number or nothing. Throws ConfigurationError with all
/// problems.
SignalRequest signal_request(const std::string& names, const std::string& collision_probability);

/// Called with the name of each stage before it is computed.
using StageObserver = std::function<void(const char* stage)>;

/// The theory of the requested signals. Empty for a model without theory.
struct SignalAnalysis {
  SignalRequest request;
  std::vector<SignalMoments> moments;  ///< in the order of request.all_names(), as is `stationary`
  std::vector<StationarySignal> stationary;
  std::optional<CollisionRisk> collisions;        ///< none if gaps are not normal
  std::vector<Amplification> amplification = {};  ///< one per vehicle 0 .. N; empty without the speed

  bool is_empty() const { return moments.empty(); }
};

/// Completes an analysis that has its request, and its moments if these are known. `string_stable`: the verdict of
/// string_stability().
SignalAnalysis analyze_signals(const Configuration& configuration, const StringTheory& theory, SignalAnalysis analysis,
                               bool string_stable, const StageObserver& begins);

/// "largest 1.158 of follower 3, head to tail 18.88": the L2 ratios of the speeds; empty if there are none.
std::string largest_and_tail(const std::vector<Amplification>& of);

/// The report's line of the amplification from a step on, without a line break. `hidden`: the reason why there is no
/// ratio behind a leader whose speed changes.
std::string amplification_line(const std::vector<Amplification>& of, std::int64_t from, const std::string& hidden);

/// The leader's signals and the followers' exact moments, by name, of all these signals but the gap; none without
/// moments.
SignalsByName exact_signals(const PlatoonModel& model, const std::vector<std::string>& names,
                            const std::vector<SignalMoments>& moments, std::int64_t steps);

/// A line for each signal and for the amplification, three for the collisions; one line where there is no theory.
std::string report(const Configuration& configuration, const SignalAnalysis& analysis);

/// Adds the keys `signals`, `collision` and `amplification` as far as they are requested; null if there is no theory.
void add_to_json(const Configuration& configuration, const SignalAnalysis& analysis, nlohmann::json& document);

}  // namespace platoon
