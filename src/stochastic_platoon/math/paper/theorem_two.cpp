#include "stochastic_platoon/math/paper/theorem_two.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/paper/norms.hpp"
#include "stochastic_platoon/math/paper/resolvent.hpp"
#include "stochastic_platoon/math/paper/string_matrices.hpp"
#include "stochastic_platoon/math/response/loop_filter.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"

namespace platoon {

namespace {

// Largest number of states of the string for the dense beta_1; beyond it beta_1 is the bound for any length.
constexpr Eigen::Index kDenseStates = 240;

// Operations allowed for the supremum of beta_2: some milliseconds.
constexpr double kOperations = 5e6;

/// Largest value and total of ||eta_N C A^k||_2^2 over k < steps; rows i < N lie below row N.
struct RowEnergy {
  double largest;
  double total;
};

RowEnergy last_row_energy(const StateSpace& vehicle, std::size_t followers, std::size_t steps) {
  const LoopFilter filter(vehicle);
  std::vector<double> energy(steps, 0.0);
  for (Eigen::Index a = 0; a < vehicle.order(); ++a) {
    std::vector<double> response = filter.free_response(Eigen::VectorXd::Unit(vehicle.order(), a), steps);
    for (std::size_t m = 0; m < followers && m < steps; ++m) {
      if (m > 0) response = filter(response);
      for (std::size_t k = 0; k < steps; ++k) energy[k] += response[k] * response[k];
    }
  }
  RowEnergy result{0.0, 0.0};
  for (const double value : energy) {
    result.largest = std::max(result.largest, value);
    result.total += value;
  }
  return result;
}

/// sup over lengths of sigma_max(response response'), with response block Toeplitz with the three blocks of
/// initial_string: the largest value of its symbol, c_0 + 2 c_1 cos + 2 c_2 cos 2.
double initial_response_gain(const InitialString& three) {
  const Eigen::VectorXd column = three.response.col(0);
  const Eigen::Index n = column.size() / 3;
  const Eigen::VectorXd own = column.head(n);
  const Eigen::VectorXd next = column.segment(n, n);
  const Eigen::VectorXd second = column.tail(n);
  const double c0 = column.squaredNorm();
  const double c1 = own.dot(next) + next.dot(second);
  const double c2 = own.dot(second);
  const auto symbol = [&](double cosine) { return c0 + 2.0 * c1 * cosine + 2.0 * c2 * (2.0 * cosine * cosine - 1.0); };
  double largest = std::max(symbol(1.0), symbol(-1.0));
  if (c2 != 0.0 && std::abs(c1) < std::abs(4.0 * c2)) largest = std::max(largest, symbol(-c1 / (4.0 * c2)));
  return largest;
}

/// The vehicle in units of the state that make C's largest entry between 1/2 and 1. No product of a gain and its
/// argument changes, but both stay in the range of double. Exact, as the unit is a power of two.
StateSpace scaled(const StateSpace& vehicle) {
  constexpr int kHarmless = 100;
  int exponent = 0;
  std::frexp(vehicle.c().cwiseAbs().maxCoeff(), &exponent);
  if (std::abs(exponent) < kHarmless) return vehicle;
  return {vehicle.a(), vehicle.b().unaryExpr([&](double b) { return std::ldexp(b, exponent); }),
          vehicle.c().unaryExpr([&](double c) { return std::ldexp(c, -exponent); })};
}

double mean_gain(const StateSpace& vehicle, double headway, std::size_t followers) {
  if (vehicle.order() * static_cast<Eigen::Index>(followers) <= kDenseStates) {
    try {
      return initial_mean_gain(vehicle, headway, followers);
    } catch (const std::invalid_argument&) {
      // The sum overflowed or lost its digits: rho(A) < 1 is known here.
    }
  }
  return initial_mean_gain_of_any_length(vehicle);
}

double covariance_gain(const StateSpace& vehicle, std::size_t followers) {
  const double peak = resolvent_peak(vehicle);  // a squared value is at most the energy of its sequence
  return std::min(initial_covariance_gain_within(vehicle, followers, kOperations).to, peak * peak);
}

}  // namespace

double initial_mean_gain(const StateSpace& vehicle, double headway, std::size_t followers) {
  const StringMatrices string = string_matrices(vehicle, headway, followers);
  const Eigen::RowVectorXd last = string.c.bottomRows(1);
  const Eigen::MatrixXd gramian = solve_discrete_lyapunov(string.a.transpose(), last.transpose() * last);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gramian, Eigen::EigenvaluesOnly);
  return std::sqrt(eigen.eigenvalues().maxCoeff());
}

double initial_mean_gain_of_any_length(const StateSpace& vehicle) {
  return resolvent_peak(vehicle);
}

GainEnclosure initial_covariance_gain_within(const StateSpace& vehicle, std::size_t followers, double operations) {
  const double energy = resolvent_energy(vehicle, followers);
  const auto n = static_cast<double>(vehicle.order());
  double seen = 0.0;
  for (std::size_t steps = 64;; steps *= 2) {
    const RowEnergy found = last_row_energy(vehicle, followers, steps);
    const double left = energy * (1.0 + 1e-9) - found.total;
    const bool none_left = found.total <= seen * (1.0 + 1e-12);  // regardless of the accuracy of `energy`
    if (left <= found.largest || none_left) return {found.largest, found.largest};
    const auto links = static_cast<double>(std::min(followers, 2 * steps));
    if (6.0 * n * n * links * static_cast<double>(2 * steps) > operations) return {found.largest, left};
    seen = found.total;
  }
}

double initial_covariance_gain(const StateSpace& vehicle, std::size_t followers) {
  return initial_covariance_gain_within(vehicle, followers, std::numeric_limits<double>::infinity()).to;
}

TheoremTwoBounds theorem_two_bounds(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const StateSpace vehicle = scaled(model.default_vehicle().loop.realization);
  PlatoonModel in_scale = model;
  in_scale.default_vehicle().loop.realization = vehicle;
  const std::vector<double> leader = leader_error(model, steps);
  const InitialString three = initial_string(in_scale, 3);  // the means of all further followers are zero
  const StringStability stability = string_stability(model);
  TheoremTwoBounds bounds{};
  bounds.leader_norm = sequence_norm(leader.data(), leader.size(), NormOrder::kTwo);
  bounds.initial_mean = followers < 3 ? initial_string(in_scale, followers).mean.norm() : three.mean.norm();
  bounds.initial_covariance = model.default_vehicle().initial_position.variance * initial_response_gain(three);
  if (stability.mean_bounded) {
    bounds.alpha_1 = stability.peak_gain * bounds.leader_norm;
    bounds.beta_1 = bounds.initial_mean > 0.0
                        ? bounds.initial_mean * mean_gain(vehicle, model.default_vehicle().headway, followers)
                        : 0.0;
    bounds.mean_bound = *bounds.alpha_1 + *bounds.beta_1;
  }
  if (stability.string_stable) {
    bounds.alpha_2 = stability.limit_variance;
    bounds.beta_2 =
        bounds.initial_covariance > 0.0 ? bounds.initial_covariance * covariance_gain(vehicle, followers) : 0.0;
    bounds.stated_beta_2 = bounds.initial_covariance * vehicle.c().squaredNorm();
    bounds.variance_bound = *bounds.alpha_2 + *bounds.beta_2;
  }
  return bounds;
}

}  // namespace platoon
