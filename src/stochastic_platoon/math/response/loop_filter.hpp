#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/state_space.hpp"

namespace platoon {

/// The closed loop T of one vehicle as an operator on finite sequences, paper eq. (ith-closedloop).
class LoopFilter {
public:
  explicit LoopFilter(const StateSpace& system);

  /// y = T u from the zero state: x(k+1) = A x(k) + B u(k), y(k) = C x(k), x(0) = 0. Same length as u.
  std::vector<double> operator()(const std::vector<double>& input) const;

  /// C A^k x(0) for k = 0 .. count-1.
  std::vector<double> free_response(const Eigen::VectorXd& initial, std::size_t count) const;

private:
  struct Term {  ///< one nonzero entry of a row
    std::size_t column;
    double value;
  };
  void advance(std::vector<double>& state, std::vector<double>& next, double input) const;
  double output(const std::vector<double>& state) const;

  std::vector<Term> terms_;           ///< nonzero entries of A, row after row
  std::vector<std::size_t> row_end_;  ///< one past the last term of each row
  std::vector<double> input_gain_;    ///< B
  std::vector<Term> output_terms_;    ///< nonzero entries of C
};

}  // namespace platoon
