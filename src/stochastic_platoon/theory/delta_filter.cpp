#include "stochastic_platoon/theory/delta_filter.hpp"

#include <cmath>

namespace platoon {

namespace {

// Smaller states count as zero: arithmetic with subnormal numbers is a hundred times slower.
constexpr long double kNegligibleState = 1e-290L;

}  // namespace

DeltaFilter::DeltaFilter(const DeltaFraction& transfer)
    : gain_(transfer.numerator.front() / transfer.denominator.front()) {
  const std::size_t n = transfer.denominator.size() - 1;
  for (std::size_t j = n; j-- > 0;) {
    numerator_.push_back(j < transfer.numerator.size() ? transfer.numerator[j] : 0.0L);
    denominator_.push_back(transfer.denominator[j]);
  }
  // 0 = v_{j+1} - d_{n-1-j} y + c_{n-1-j} u
  equilibrium_.push_back(gain_);
  for (std::size_t j = 0; j + 1 < n; ++j) equilibrium_.push_back(denominator_[j] * gain_ - numerator_[j]);
}

void DeltaFilter::advance(Sequence& state, Scalar input) const {
  const Scalar output = state.front();
  const std::size_t n = state.size();
  for (std::size_t j = 0; j < n; ++j) {
    const Scalar next = j + 1 < n ? state[j + 1] : 0.0L;
    state[j] += next - denominator_[j] * output + numerator_[j] * input;
    if (std::abs(state[j]) < kNegligibleState) state[j] = 0.0L;
  }
}

DeltaFilter::Sequence DeltaFilter::operator()(const Sequence& input) const {
  Sequence state(numerator_.size(), 0.0L);
  Sequence response(input.size());
  for (std::size_t k = 0; k < input.size(); ++k) {
    response[k] = state.front();
    advance(state, input[k]);
  }
  return response;
}

DeltaFilter::Sequence DeltaFilter::free_response(std::size_t count) const {
  Sequence state = equilibrium_;
  for (Scalar& value : state) value /= gain_;
  Sequence response(count);
  for (std::size_t k = 0; k < count; ++k) {
    response[k] = state.front();
    advance(state, 0.0L);
  }
  return response;
}

DeltaFilter::Sequence DeltaFilter::lag(const Sequence& moved) const {
  Sequence state(numerator_.size(), 0.0L);
  Sequence response(moved.size(), 0.0L);
  for (std::size_t k = 1; k < moved.size(); ++k) {
    advance(state, 0.0L);
    for (std::size_t j = 0; j < state.size(); ++j) state[j] -= equilibrium_[j] * moved[k];
    response[k] = state.front();
  }
  return response;
}

}  // namespace platoon
