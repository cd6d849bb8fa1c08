#include "stochastic_platoon/math/response/loop_filter.hpp"

#include <cmath>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

// Smaller states count as zero: arithmetic with subnormal numbers is a hundred times slower.
constexpr double kNegligible = 1e-290;

}  // namespace

LoopFilter::LoopFilter(const StateSpace& system) {
  for (Eigen::Index i = 0; i < system.order(); ++i) {
    for (Eigen::Index j = 0; j < system.order(); ++j) {
      if (system.a()(i, j) != 0.0) terms_.push_back({static_cast<std::size_t>(j), system.a()(i, j)});
    }
    row_end_.push_back(terms_.size());
    input_gain_.push_back(system.b()(i));
    if (system.c()(i) != 0.0) output_terms_.push_back({static_cast<std::size_t>(i), system.c()(i)});
  }
}

void LoopFilter::advance(std::vector<double>& state, std::vector<double>& next, double input) const {
  const Term* term = terms_.data();
  for (std::size_t i = 0; i < state.size(); ++i) {
    double sum = input_gain_[i] * input;
    for (const Term* const end = terms_.data() + row_end_[i]; term != end; ++term) {
      sum += term->value * state[term->column];
    }
    next[i] = std::abs(sum) < kNegligible ? 0.0 : sum;
  }
  state.swap(next);
}

double LoopFilter::output(const std::vector<double>& state) const {
  double sum = 0.0;
  for (const Term& term : output_terms_) sum += term.value * state[term.column];
  return sum;
}

std::vector<double> LoopFilter::operator()(const std::vector<double>& input) const {
  check_interruption();
  std::vector<double> state(row_end_.size(), 0.0);
  std::vector<double> next(row_end_.size());
  std::vector<double> response(input.size());
  for (std::size_t k = 0; k < input.size(); ++k) {
    response[k] = output(state);
    advance(state, next, input[k]);
  }
  return response;
}

std::vector<double> LoopFilter::free_response(const Eigen::VectorXd& initial, std::size_t count) const {
  check_interruption();
  std::vector<double> state(initial.data(), initial.data() + initial.size());
  std::vector<double> next(state.size());
  std::vector<double> response(count);
  for (std::size_t k = 0; k < count; ++k) {
    response[k] = output(state);
    advance(state, next, 0.0);
  }
  return response;
}

}  // namespace platoon
