#include "stochastic_platoon/analysis/analysis.hpp"

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/io/text.hpp"
#include "stochastic_platoon/theory/rounding_bound.hpp"
#include "stochastic_platoon/theory/stationary_variance.hpp"

namespace platoon {

namespace {

nlohmann::json number(std::optional<double> value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json numbers(const std::vector<double>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

nlohmann::json rows(const std::vector<double>& values, std::size_t length) {
  nlohmann::json list = nlohmann::json::array();
  for (auto row = values.begin(); row != values.end(); row += static_cast<std::ptrdiff_t>(length)) {
    list.push_back(numbers({row, row + static_cast<std::ptrdiff_t>(length)}));
  }
  return list;
}

nlohmann::json coefficients(const Polynomial& polynomial) {
  return numbers({polynomial.data(), polynomial.data() + polynomial.size()});
}

std::string shown(std::optional<double> value, const char* unit) {
  return value ? formatted("%.6g %s", *value, unit) : "none";
}

std::string shown(const std::vector<HeadwayInterval>& intervals) {
  std::string text;
  for (const HeadwayInterval& interval : intervals)
    text += formatted(" [%.6g, %.6g]", interval.from, interval.to);
  return text.empty() ? " none" : text;
}

std::string headway_lines(const Analysis& analysis) {
  if (!analysis.headways)
    return "Critical headway: none, as the closed loop itself was given and fits one headway\n";
  const StableHeadways& headways = *analysis.headways;
  const std::string critical =
      headways.critical ? formatted("%.9g sample periods", *headways.critical) : "none";
  return "Critical headway: " + critical +
         formatted("; string stable headways within [%.6g, %.6g]:", headways.searched.from,
                   headways.searched.to) +
         shown(headways.intervals) + "\n";
}

LoopDesign with_gain(const LoopDesign& design, double gain) {
  const TransferFunction& controller = design.controller;
  return {design.plant,
          {controller.numerator() * (gain / controller.numerator()(0)), controller.denominator()},
          design.divide_by_one_plus_headway};
}

}  // namespace

Analysis analyze(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  Analysis analysis{string_stability(model),
                    {},
                    stationary_variances(model, followers),
                    error_moments(model, followers, steps),
                    {},
                    {}};
  analysis.norms = error_norms(analysis.moments, NormOrder::kTwo, NormOrder::kInfinity);
  if (analysis.stability.mean_square_stable) analysis.bounds = theorem_two_bounds(model, followers, steps);
  if (model.design) {
    analysis.headways =
        stable_headways([&model](double headway) { return close_loop(*model.design, headway); },
                        headways_about(model.headway));
  }
  analysis.integral_defect = integral_defect(model.loop, model.headway);
  analysis.rounding = rounding_bound_of_a_metre(model.loop.realization, static_cast<std::size_t>(steps));
  return analysis;
}

std::vector<SweepPoint> sweep(const PlatoonModel& model, const std::vector<double>& headways,
                              const std::vector<double>& gains) {
  if (!model.design) {
    throw std::invalid_argument("closed_loop: given: must be plant and controller for a sweep over headways");
  }
  const std::vector<double> own_gain{model.design->controller.numerator()(0)};
  std::vector<SweepPoint> points;
  for (const double gain : gains.empty() ? own_gain : gains) {
    for (const double headway : headways) {
      PlatoonModel varied = model;
      varied.headway = headway;
      varied.loop = close_loop(with_gain(*model.design, gain), headway);
      points.push_back({headway, gain, string_stability(varied)});
    }
  }
  return points;
}

std::string report(const PlatoonModel& model, const Analysis& analysis) {
  const StringStability& stability = analysis.stability;
  std::string text =
      formatted("h = %g, P_d = %g m^2: ", model.headway, model.noise_variance) + stability.reason + "\n";
  text += formatted("rho(A) = %.6g: the errors' mean and variance %s over time\n", stability.spectral_radius,
                    stability.mean_square_stable ? "settle" : "DO NOT SETTLE");
  text +=
      formatted("peak of |T| = %.9g at w = %.6g rad/sample\n", stability.peak_gain, stability.peak_frequency);
  text += headway_lines(analysis);
  const std::vector<double>& stationary = analysis.stationary_variance;
  text += formatted(
              "Stationary variance: %.6g m^2 of follower 1, %.6g m^2 of follower %zu; of an endless string: ",
              stationary.front(), stationary.back(), stationary.size()) +
          shown(stability.limit_variance, "m^2") + "\n";
  text += formatted(
      "Largest norms over %zu followers and %lld steps: ||mean||_2 = %.6g m, ||variance||_inf = %.6g m^2\n",
      analysis.moments.followers, static_cast<long long>(analysis.moments.steps),
      sequence_norm(analysis.norms.mean.data(), analysis.norms.mean.size(), NormOrder::kInfinity),
      sequence_norm(analysis.norms.variance.data(), analysis.norms.variance.size(), NormOrder::kInfinity));
  if (analysis.bounds) {
    const TheoremTwoBounds& bounds = *analysis.bounds;
    text += "Bounds of Theorem 2: mean " + shown(bounds.mean_bound, "m") + " (alpha_1 " +
            shown(bounds.alpha_1, "m") + ", beta_1 " + shown(bounds.beta_1, "m") + "), variance " +
            shown(bounds.variance_bound, "m^2") + " (alpha_2 " + shown(bounds.alpha_2, "m^2") + ", beta_2 " +
            shown(bounds.beta_2, "m^2") + "; the paper's beta_2 " + shown(bounds.stated_beta_2, "m^2") +
            ")\n";
  } else {
    text += "Bounds of Theorem 2: none, as rho(A) is not below 1\n";
  }
  if (analysis.rounding > 1e-9) {
    text += formatted(
        "Warning: a run keeps a position of 1 m to %.1g m only, as the coefficients of A, B and C lose "
        "digits in "
        "double; the figures above do not, but hold for the numbers given, each of which is a rounded one\n",
        analysis.rounding);
  }
  if (analysis.integral_defect > 1e-9) {
    text += formatted(
        "Warning: A, B and C have T(1) = 1 and dT/dz(1) = -h to %.1g only: a verdict so near to its border, "
        "and as many digits of the limit, they do not determine\n",
        analysis.integral_defect);
  }
  return text;
}

nlohmann::json to_json(const PlatoonModel& model, const Analysis& analysis) {
  const StringStability& stability = analysis.stability;
  const auto steps = static_cast<std::size_t>(analysis.moments.steps);
  nlohmann::json headways = nlohmann::json::array();
  if (analysis.headways) {
    for (const HeadwayInterval& interval : analysis.headways->intervals)
      headways.push_back({interval.from, interval.to});
  }
  nlohmann::json norms = {
      {"mean_l2", numbers(analysis.norms.mean)},
      {"variance_linf", numbers(analysis.norms.variance)},
      {"mean_bound", number(analysis.bounds ? analysis.bounds->mean_bound : std::nullopt)},
      {"variance_bound", number(analysis.bounds ? analysis.bounds->variance_bound : std::nullopt)}};
  nlohmann::json bounds;
  if (analysis.bounds) {
    bounds = {{"alpha_1", number(analysis.bounds->alpha_1)},
              {"beta_1", number(analysis.bounds->beta_1)},
              {"alpha_2", number(analysis.bounds->alpha_2)},
              {"beta_2", number(analysis.bounds->beta_2)},
              {"stated_beta_2", number(analysis.bounds->stated_beta_2)}};
  }
  return {{"headway", model.headway},
          {"noise_variance", model.noise_variance},
          {"transfer",
           {{"numerator", coefficients(model.loop.transfer.numerator())},
            {"denominator", coefficients(model.loop.transfer.denominator())}}},
          {"spectral_radius", stability.spectral_radius},
          {"rounding", number(analysis.rounding)},
          {"integral_defect", number(analysis.integral_defect)},
          {"peak_gain", number(stability.peak_gain)},
          {"peak_frequency", number(stability.peak_frequency)},
          {"mean_square_stable", stability.mean_square_stable},
          {"string_stable", stability.string_stable},
          {"reason", stability.reason},
          {"critical_headway", number(analysis.headways ? analysis.headways->critical : std::nullopt)},
          {"stable_headways", analysis.headways ? headways : nlohmann::json()},
          {"stationary_variance", numbers(analysis.stationary_variance)},
          {"limit_variance", number(stability.limit_variance)},
          {"mean", rows(analysis.moments.mean, steps)},
          {"variance", rows(analysis.moments.variance, steps)},
          {"norms", norms},
          {"bounds", bounds}};
}

nlohmann::json to_json(const std::vector<SweepPoint>& points) {
  nlohmann::json list = nlohmann::json::array();
  for (const SweepPoint& point : points) {
    list.push_back({{"headway", point.headway},
                    {"gain", point.gain},
                    {"spectral_radius", point.stability.spectral_radius},
                    {"peak_gain", number(point.stability.peak_gain)},
                    {"string_stable", point.stability.string_stable},
                    {"limit_variance", number(point.stability.limit_variance)}});
  }
  return list;
}

std::string to_csv(const std::vector<SweepPoint>& points) {
  std::string text = "headway,gain,spectral_radius,peak_gain,string_stable\n";
  for (const SweepPoint& point : points) {
    text +=
        formatted("%.17g,%.17g,%.17g,%.17g,%d\n", point.headway, point.gain, point.stability.spectral_radius,
                  point.stability.peak_gain, point.stability.string_stable ? 1 : 0);
  }
  return text;
}

}  // namespace platoon
