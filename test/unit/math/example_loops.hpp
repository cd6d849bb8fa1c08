#pragma once

#include <complex>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "unit/math/model/fractions.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {

struct ExampleLoop {
  std::string name;
  double headway;
  ClosedLoop loop;
};

/// Closed loops of orders 2 to 6, with complex poles, slow poles, cancellations and several realizations.
inline std::vector<ExampleLoop> example_loops() {
  using Pair = std::complex<double>;
  const auto canonical = [](const TransferFunction& t) { return closed_loop_from(observable_canonical(t)); };
  std::vector<ExampleLoop> loops;
  loops.push_back({"paper stable", 3.2, paper_loop(3.2)});
  loops.push_back({"paper unstable", 2.4, paper_loop(2.4)});
  const TransferFunction two = ramp_tracking(polynomial_with_zeros({std::polar(0.6, 0.9)}), 1.5);
  loops.push_back({"order 2, complex", 1.5, canonical(two)});
  const TransferFunction slow = ramp_tracking(polynomial_with_zeros({0.999, 0.4}), 2500.0);
  loops.push_back({"order 2, slow", 2500.0, canonical(slow)});
  const TransferFunction four =
      ramp_tracking(polynomial_with_zeros({0.3, -0.5, std::polar(0.85, 1.7)}), 4.0, Eigen::VectorXd::Constant(1, 0.05));
  loops.push_back({"order 4, complex", 4.0, canonical(four)});
  const TransferFunction five =
      ramp_tracking(polynomial_with_zeros({0.2, Pair(0.5, 0.4), Pair(-0.6, 0.5)}), 3.0, Eigen::Vector2d(0.02, -0.01));
  loops.push_back({"order 5, complex", 3.0, canonical(five)});
  const TransferFunction six =
      ramp_tracking(polynomial_with_zeros({0.9, 0.1, std::polar(0.999, 2.0), std::polar(0.7, 0.3)}), 12.0,
                    Eigen::Vector2d(1e-3, 0.0));
  loops.push_back({"order 6, resonant", 12.0, canonical(six)});

  // Plant with a stable mode that the controller cancels, and actuator lag: order 4 after reduction.
  const TransferFunction plant(Eigen::VectorXd::Constant(1, 0.02),
                               multiply(Eigen::Vector3d(1.0, -2.0, 1.0), polynomial_with_zeros({0.8, 0.5})));
  const TransferFunction controller(multiply(polynomial_with_zeros({0.8}), Eigen::Vector2d(1.0, -0.9)),
                                    polynomial_with_zeros({0.1, -0.2}));
  loops.push_back({"cancellation", 5.0, close_loop({plant, controller}, 5.0)});

  loops.push_back({"paper, dense realization", 3.2, closed_loop_from(dense_paper_loop())});
  return loops;
}

/// T = D(1) / D(z), at the headway at which it tracks ramps, h = D'(1) / D(1).
inline ExampleLoop all_pole(const std::string& name, const Polynomial& d) {
  const double headway = derivative(d).sum() / d.sum();
  return {name, headway, closed_loop_from(observable_canonical({Polynomial::Constant(1, d.sum()), d}))};
}

/// T = D(1) / D(z) with |T|^2 = 1 / p(1 - cos w), from the zeros of p, p(0) = 1: to each belong z and 1/z.
inline ExampleLoop with_gain_from(const std::string& name, const std::vector<std::complex<double>>& zeros) {
  std::vector<std::complex<double>> poles;
  for (const std::complex<double>& t : zeros) {
    const std::complex<double> offset = std::sqrt(t * (t - 2.0)), a = 1.0 - t + offset, b = 1.0 - t - offset;
    poles.push_back(std::abs(a) < std::abs(b) ? a : b);
  }
  return all_pole(name, polynomial_with_all_zeros(poles));
}

/// String stable loops of orders 2 to 6.
inline std::vector<ExampleLoop> string_stable_loops() {
  using Pair = std::complex<double>;
  std::vector<ExampleLoop> loops;
  loops.push_back({"paper", 3.2, paper_loop(3.2)});
  loops.push_back({"paper near its border", 2.8001, paper_loop(2.8001)});
  const auto tracking = [](const Polynomial& d, double headway) {
    return closed_loop_from(observable_canonical(ramp_tracking(d, headway)));
  };
  loops.push_back({"order 2, slow", 1001.0, tracking(polynomial_with_zeros({0.999, 0.4}), 1001.0)});
  loops.push_back({"order 3, complex", 4.0, tracking(polynomial_with_zeros({0.3, std::polar(0.6, 0.5)}), 4.0)});
  loops.push_back(
      {"order 3, slow complex", 2000.0, tracking(polynomial_with_zeros({0.4, std::polar(0.999, 5e-4)}), 2000.0)});
  loops.push_back(all_pole("order 4, real", polynomial_with_zeros({0.9, 0.5, 0.3, 0.1})));
  loops.push_back(all_pole("order 5, complex", polynomial_with_zeros({0.8, Pair(0.5, 0.2), Pair(0.2, 0.1)})));
  loops.push_back(all_pole("order 6, slow", polynomial_with_zeros({0.999, 0.9, Pair(0.6, 0.2), Pair(0.3, 0.2)})));
  loops.push_back(with_gain_from("flat, 1 - |T|^2 of order w^4", {Pair(0.0, 0.5), Pair(0.0, -0.5)}));
  return loops;
}

inline PlatoonModel model_with(const ClosedLoop& loop, double headway) {
  const LeaderProfile leader({{0, 20.0}, {25, 5.0}, {40, 12.0}}, 0.1);
  VehicleModel vehicle(loop, headway);
  vehicle.standstill_distance = 7.0;
  vehicle.position().noise_variance = 0.6;
  vehicle.initial_position = {0.8, 0.3};
  return {vehicle, leader};
}

}  // namespace platoon
