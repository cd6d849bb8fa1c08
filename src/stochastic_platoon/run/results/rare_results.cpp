#include "stochastic_platoon/run/results/rare_results.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"
#include "stochastic_platoon/run/io/csv_text.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"

namespace platoon {

namespace {

constexpr double kSecondsPerHour = 3600.0;
constexpr double kUnseen = 1.5;        // samples
constexpr double kNotable = 0.1;       // share of the upper end
constexpr double kLargestError = 0.2;  // relative, up to which the interval of a splitting holds
using boost::math::double_constants::ln_ten;

// ln(-ln(1 - P)).
double log_hazard(double log_probability) {
  if (log_probability < -30.0) return log_probability;
  return log_probability < 0.0 ? std::log(-std::log1p(-std::exp(log_probability))) : kNaN;
}

/// An estimate by the weights of one event, and how far its interval reaches to either side.
struct Estimate {
  double log_probability = kNaN, relative_error = kNaN, reach = kNaN;

  Estimate(double log_scale, const Moments& weight) {
    if (!(weight.mean > 0.0)) return;  // nothing has been reached
    const auto n = static_cast<double>(weight.count);
    log_probability = log_scale + std::log(weight.mean);
    if (weight.count < 2) return;
    relative_error = std::sqrt(weight.squared_deviations / (n - 1.0) / n) / weight.mean;
    reach = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975) *
            std::sqrt(relative_error * relative_error + kUnseen * kUnseen / (n * n));
  }
};

// `weights`: of the row's nested events.
RareRow row_of(const Configuration& configuration, const RareEstimator& estimator, std::size_t row,
               const Moments* weights) {
  RareRow of{row < configuration.run.followers ? std::to_string(row + 1) : "any", kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  const std::vector<double> scales = estimator.log_scales(row);
  const auto [least, most] = estimator.log_limits(row);
  if (std::isfinite(most)) of.log_bound = most;
  of.problem = estimator.problem(row);
  if (of.problem.empty() && scales.back() == -kInfinity) {
    of.log_probability = of.log_lower = of.log_upper = of.log_bound = of.log_per_hour = -kInfinity;
    of.relative_error = 0.0;
    return of;
  }
  const auto limited = [least = least, most = std::min(most, 0.0)](double x) {
    return std::max(least, std::min(x, most));
  };
  std::vector<Estimate> nested;
  for (std::size_t event = 0; event < scales.size(); ++event) nested.emplace_back(scales[event], weights[event]);
  if (of.problem.empty()) {
    const Estimate& own = nested.back();
    if (std::isnan(own.log_probability)) {
      of.problem = "row " + of.vehicle + ": no repetition reaches the last level: realizations must be more";
    } else {
      of.log_probability = limited(own.log_probability);
      of.log_per_hour = log_per_hour(configuration, of.log_probability);
      of.relative_error = own.relative_error;
      if (!std::isnan(own.reach)) of.log_lower = limited(of.log_probability - own.reach);
    }
  }
  std::size_t deepest = nested.size();
  while (deepest > 1 && !(nested[deepest - 1].relative_error <= kLargestError)) --deepest;
  if (deepest == 0 || std::isnan(nested[deepest - 1].reach)) return of;
  const double upper = std::max(nested[deepest - 1].log_probability + nested[deepest - 1].reach,
                                nested.back().log_probability + nested.back().reach);
  const RareEstimator::Unseen unseen = estimator.unseen(row);
  of.log_upper = limited(unseen.probability > 0.0 ? std::log(std::exp(upper) + unseen.probability) : upper);
  if (deepest < nested.size() && of.problem.empty())
    of.problem = formatted(
        "row %s: an error of %.0f %% is too large for an upper end: it is that of gaps below %g m; realizations must be more for a nearer one",
        of.vehicle.c_str(), 100.0 * of.relative_error, estimator.levels(row)[deepest - 1]);
  if (unseen.probability > kNotable * std::exp(upper)) {
    if (!of.problem.empty()) of.problem += "; ";
    of.problem += formatted(
        "row %s: the estimate is without realizations of probability %.2g at most, which its paths hardly contain, and the upper end counts them as events: %s",
        of.vehicle.c_str(), unseen.probability, unseen.what.c_str());
  }
  return of;
}

nlohmann::json number_of_log(double x) {
  const double value = std::exp(x);
  return value > 0.0 || x == -std::numeric_limits<double>::infinity() ? number(value) : nlohmann::json();
}

}  // namespace

double log_per_hour(const Configuration& configuration, double log_probability) {
  const RunOptions& run = configuration.run;
  const double hours =
      static_cast<double>(run.steps - run.burn_in) * configuration.model.sample_period / kSecondsPerHour;
  return log_hazard(log_probability) - std::log(hours);
}

std::vector<RareRow> rare_rows(const Configuration& configuration, const RareEstimator& estimator,
                               const std::vector<Moments>& weights) {
  std::vector<RareRow> rows;
  const Moments* of_row = weights.data();
  for (std::size_t row = 0; row <= configuration.run.followers; ++row) {
    rows.push_back(row_of(configuration, estimator, row, of_row));
    of_row += estimator.log_scales(row).size();
  }
  return rows;
}

std::string decimal_of_log(double x) {
  if (std::isnan(x)) return "";
  if (x == -std::numeric_limits<double>::infinity()) return "0";
  if (x > -700.0) return formatted("%.17g", std::exp(x));
  const double exponent = std::floor(x / ln_ten);
  return formatted("%.12ge%.0f", std::exp(x - exponent * ln_ten), exponent);
}

std::string rare_csv(const std::vector<RareRow>& rows) {
  CsvText csv("vehicle,probability,standard_error,lower,upper,bound,per_hour");
  csv.end_row();
  for (const RareRow& of : rows) {
    csv.add(of.vehicle, decimal_of_log(of.log_probability),
            decimal_of_log(of.log_probability + std::log(of.relative_error)));
    csv.add(decimal_of_log(of.log_lower), decimal_of_log(of.log_upper), decimal_of_log(of.log_bound));
    csv.add(decimal_of_log(of.log_per_hour));
    csv.end_row();
  }
  return csv.text();
}

std::string rare_json(const Configuration& configuration, const RareOptions& options, std::uint64_t samples,
                      const std::vector<RareRow>& rows, const nlohmann::json& details) {
  const RunOptions& run = configuration.run;
  nlohmann::json document = provenance(configuration);
  document["method"] = options.method;
  document["below"] = options.below;
  document["burn_in"] = run.burn_in;
  document["samples"] = samples;
  document["counted_seconds"] = static_cast<double>(run.steps - run.burn_in) * configuration.model.sample_period;
  const auto settling = settling_steps(configuration.model, run.followers);
  document["settling_steps"] = settling ? nlohmann::json(*settling) : nlohmann::json();
  if (options.speed) document["speed"] = *options.speed;
  for (const RareRow& of : rows) {
    nlohmann::json entry = {{"vehicle", of.vehicle},
                            {"probability", number_of_log(of.log_probability)},
                            {"log10_probability", number(of.log_probability / ln_ten)},
                            {"relative_error", number(of.relative_error)},
                            {"standard_error", number_of_log(of.log_probability + std::log(of.relative_error))},
                            {"lower", number_of_log(of.log_lower)},
                            {"upper", number_of_log(of.log_upper)},
                            {"bound", number_of_log(of.log_bound)},
                            {"per_hour", number_of_log(of.log_per_hour)}};
    if (options.speed) {
      const double kilometres_per_hour = 3.6 * *options.speed;
      entry["per_kilometre"] = number_of_log(of.log_per_hour - std::log(kilometres_per_hour));
    }
    document["rows"].push_back(std::move(entry));
  }
  document.update(details);
  return with_checksums(std::move(document), {{"rare.csv", rare_csv(rows)}});
}

std::string rare_report(const Configuration& configuration, const RareOptions& options, std::uint64_t samples,
                        const std::vector<RareRow>& rows) {
  const RunOptions& run = configuration.run;
  std::string text = formatted(
      "Probability that a gap is below %g m at one of the steps %lld to %lld (%s); %llu %s\n", options.below,
      static_cast<long long>(run.burn_in), static_cast<long long>(run.steps - 1),
      duration(run.steps - run.burn_in, configuration.model).c_str(), static_cast<unsigned long long>(samples),
      options.method == "condition" ? "conditioned realizations" : "repetitions of a splitting");
  text += "follower    probability   error [%]   95 % from        to             bound       per hour\n";
  const auto shown = [](double log_value) {
    const std::string decimal = decimal_of_log(log_value);
    const std::size_t exponent = decimal.find('e');
    if (decimal.empty()) return std::string("-");
    if (log_value <= -700.0 && exponent != std::string::npos)
      return formatted("%.4g", std::strtod(decimal.substr(0, exponent).c_str(), nullptr)) + decimal.substr(exponent);
    return formatted("%.5g", std::exp(log_value));
  };
  for (const RareRow& of : rows) {
    const auto follower = static_cast<std::size_t>(&of - rows.data()) + 1;
    if (run.followers > 30 && follower > 10 && follower + 10 <= run.followers) continue;
    text += formatted("%8s %14s %11s %12s %12s %12s %12s\n", of.vehicle.c_str(), shown(of.log_probability).c_str(),
                      std::isnan(of.relative_error) ? "-" : formatted("%.2g", 100.0 * of.relative_error).c_str(),
                      shown(of.log_lower).c_str(), shown(of.log_upper).c_str(), shown(of.log_bound).c_str(),
                      shown(of.log_per_hour).c_str());
  }
  const auto settling = settling_steps(configuration.model, run.followers);
  if (!settling || *settling > run.burn_in) {
    text +=
        "per hour includes the start, in which the gaps scatter less: " +
        (settling ? formatted("its transient takes %lld steps; for a long drive use --burn-in %lld and more steps\n",
                              static_cast<long long>(*settling), static_cast<long long>(*settling))
                  : std::string("the start of an unstable loop never ends\n"));
  }
  return text;
}

}  // namespace platoon
