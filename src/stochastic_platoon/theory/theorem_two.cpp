#include "stochastic_platoon/theory/theorem_two.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/theory/error_moments.hpp"
#include "stochastic_platoon/theory/lemma_one.hpp"
#include "stochastic_platoon/theory/loop_filter.hpp"
#include "stochastic_platoon/theory/norms.hpp"
#include "stochastic_platoon/theory/resolvent.hpp"
#include "stochastic_platoon/theory/string_matrices.hpp"
#include "stochastic_platoon/theory/string_stability.hpp"

namespace platoon {

namespace {

constexpr Eigen::Index kDenseStates = 240;      // beyond, beta_1 is the bound that holds for any length
constexpr std::size_t kFollowersInFull = 2000;  // and beyond these, so is beta_2

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

/// sup over lengths of sigma_max(response response'), response block Toeplitz with the three blocks of
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
  const auto symbol = [&](double cosine) {
    return c0 + 2.0 * c1 * cosine + 2.0 * c2 * (2.0 * cosine * cosine - 1.0);
  };
  double largest = std::max(symbol(1.0), symbol(-1.0));
  if (c2 != 0.0 && std::abs(c1) < std::abs(4.0 * c2)) largest = std::max(largest, symbol(-c1 / (4.0 * c2)));
  return largest;
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

double initial_covariance_gain(const StateSpace& vehicle, std::size_t followers) {
  const double energy = resolvent_energy(vehicle, followers);
  double seen = 0.0;
  for (std::size_t steps = 64;; steps *= 2) {
    const RowEnergy found = last_row_energy(vehicle, followers, steps);
    const bool none_left = found.total <= seen * (1.0 + 1e-12);  // whatever the digits of `energy`
    if (energy - found.total <= found.largest || none_left) return found.largest;
    seen = found.total;
  }
}

TheoremTwoBounds theorem_two_bounds(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const StateSpace& vehicle = model.loop.realization;
  const std::vector<double> leader = leader_error(model, steps);
  const InitialString three = initial_string(model, 3);  // the means of all further followers are zero
  const StringStability stability = string_stability(model);
  TheoremTwoBounds bounds{};
  bounds.leader_norm = sequence_norm(leader.data(), leader.size(), NormOrder::kTwo);
  bounds.initial_mean = followers < 3 ? initial_string(model, followers).mean.norm() : three.mean.norm();
  bounds.initial_covariance = model.initial_position.variance * initial_response_gain(three);
  if (stability.mean_bounded) {
    const bool dense = vehicle.order() * static_cast<Eigen::Index>(followers) <= kDenseStates;
    const double gain = dense ? initial_mean_gain(vehicle, model.headway, followers)
                              : initial_mean_gain_of_any_length(vehicle);
    bounds.alpha_1 = stability.peak_gain * bounds.leader_norm;
    bounds.beta_1 = gain * bounds.initial_mean;
    bounds.mean_bound = *bounds.alpha_1 + *bounds.beta_1;
  }
  if (stability.string_stable) {
    bounds.alpha_2 = stability.limit_variance;
    const double peak = resolvent_peak(vehicle);  // a value is at most the energy of its sequence
    bounds.beta_2 =
        bounds.initial_covariance *
        (followers <= kFollowersInFull ? initial_covariance_gain(vehicle, followers) : peak * peak);
    bounds.stated_beta_2 = bounds.initial_covariance * vehicle.c().squaredNorm();
    bounds.variance_bound = *bounds.alpha_2 + *bounds.beta_2;
  }
  return bounds;
}

}  // namespace platoon
