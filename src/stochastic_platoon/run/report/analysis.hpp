#pragma once

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/math/paper/norms.hpp"
#include "stochastic_platoon/math/paper/theorem_two.hpp"
#include "stochastic_platoon/math/string/critical_burst.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/critical_leader_share.hpp"
#include "stochastic_platoon/math/string/critical_loss.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/report/robustness.hpp"
#include "stochastic_platoon/run/report/signal_analysis.hpp"

namespace platoon {

/// All results of the theory for a platoon (paper, sections 4 and 5). Without a theory (losses in bursts by radio) only
/// `without_theory`, `rounding` and `integral_defect` are set.
struct Analysis {
  std::optional<std::string> without_theory = {};  ///< the reason
  StringStability stability;
  std::optional<double> string_margin = {};
  std::optional<StableHeadways> headways;    ///< none if the closed loop was given directly: it fits one headway only
  std::optional<StableLosses> losses = {};   ///< none without a loss stage
  std::optional<CriticalBurst> bursts = {};  ///< none without losses
  std::optional<StableLeaderShares> leader_shares =
      {};                                            ///< none unless positions of the leader and of others are heard
  std::vector<double> frequencies = {}, gains = {};  ///< [rad/sample], and StringTheory::gains() there
  Robustness robustness = {};                        ///< of the loop and of the radio
  std::vector<double> stationary_mean = {};          ///< [m], one per follower, caused by delays and losses
  std::vector<double> stationary_variance;           ///< [m^2], one per follower; NaN if there is none
  /// Where a vehicle hears more than a position: the shares of its inputs in it, noise and losses, per follower.
  std::vector<std::vector<double>> stationary_variance_by_input = {};
  /// Why these variances, or those of an endless string, are missing though they exist; empty if none is.
  std::string not_computed = {};
  SignalMoments moments;
  ErrorNorms norms;                        ///< L_2 of the means, L_infinity of the variances
  std::optional<TheoremTwoBounds> bounds;  ///< none for an unstable loop, or for a platoon other than the paper's
  double rounding = 0.0;                   ///< [m] error of the vehicles' arithmetic in a position of 1 m
  double integral_defect = 0.0;  ///< deviation from T(1) = 1 and dT/dz(1) = -h: limits the accuracy of verdicts
  std::vector<std::string> contradictions = {};  ///< see contradictions()
  std::vector<std::string> warnings = {};        ///< see plausibility_warnings()
  SignalAnalysis signals = {};                   ///< of the signals requested
  std::shared_ptr<const Analysis> linear = {};   ///< of the same cars without limits; null if they have none
  std::vector<double> beyond_limits = {};        ///< see beyond_limits(); empty without limits
};

/// The analysis of a configuration's platoon over its steps. Throws ConfigurationError for an endless run, for a
/// burn-in without amplification, and for more steps than the theory of losses in bursts can be computed for.
///
/// `keys`: keys of the JSON document that are needed, those of `linear` also as linear/KEY; empty: all. A figure is
/// computed only for its own key, and the values of other keys are then null, empty or missing.
Analysis analyze(
    const Configuration& configuration, const SignalRequest& signals = {},
    const StageObserver& begins = [](const char*) {}, const std::set<std::string>& keys = {});

/// JSON for programs; missing values are null, and `not_computed` is one of the warnings.
nlohmann::json to_json(const Configuration& configuration, const Analysis& analysis);

}  // namespace platoon
