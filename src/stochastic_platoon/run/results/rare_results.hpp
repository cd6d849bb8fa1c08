#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/rare/rare_event.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// What rare estimates.
struct RareOptions {
  double below = 0.0;                ///< [m]
  std::string method;                ///< condition or split
  std::optional<double> speed = {};  ///< [m/s], for figures per kilometre
};

/// A probability as its natural logarithm, which may be below the range of double. NaN: unknown.
struct RareRow {
  std::string vehicle;  ///< number of the follower, or "any"
  double log_probability;
  double relative_error;        ///< standard error / probability
  double log_lower, log_upper;  ///< ends of the interval of 95 %
  double log_bound;             ///< upper bound of the theory
  double log_per_hour;          ///< -ln(1 - P) per hour of the counted steps
  std::string problem = {};     ///< the reason why there is no estimate, or no upper end of its own
};

/// ln of the events per hour, -ln(1 - P) over the hours that count, from ln P.
double log_per_hour(const Configuration& configuration, double log_probability);

/// The rows of the followers 1, 2, ... and of any of them.
///
/// The interval is that of a normal logarithm, by Student's t: P exp(-/+ t s), s the relative standard error, at least
/// 1.5 / n for n samples, as these do not show what happens once in n samples. Behind the first of several nested
/// events, an s above 0.2 means that few of the samples make up the estimate, which is then mostly too small. The upper
/// end is at least that of the deepest of the row's events whose s is at most 0.2, as P is below its probability.
/// What no sample is likely to see (RareEstimator::unseen()) is added to the upper end. Estimate and interval are cut
/// off at the limits of the theory. `weights`: of all nested events of all rows.
std::vector<RareRow> rare_rows(const Configuration& configuration, const RareEstimator& estimator,
                               const std::vector<Moments>& weights);

/// The decimal number e^x, also outside of the range of double: "1.234567890123e-412"; empty for NaN.
std::string decimal_of_log(double x);

/// rare.csv; and rare.json, with the provenance, the figures per kilometre and checksums of both as in summary.json.
std::string rare_csv(const std::vector<RareRow>& rows);
std::string rare_json(const Configuration& configuration, const RareOptions& options, std::uint64_t samples,
                      const std::vector<RareRow>& rows, const nlohmann::json& details);

/// The same for a terminal.
std::string rare_report(const Configuration& configuration, const RareOptions& options, std::uint64_t samples,
                        const std::vector<RareRow>& rows);

}  // namespace platoon
