#include "stochastic_platoon/delivery/sequence.hpp"

#include <cstring>

#include "stochastic_platoon/model/vector_clones.hpp"

namespace platoon {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::in_turn:
      return "in turn";
    case Verdict::stale:
      return "stale";
    case Verdict::missed_start:
      return "of an attempt whose start was missed";
    case Verdict::out_of_turn:
      return "out of turn";
    case Verdict::wrong_size:
      return "wrong batch size";
    case Verdict::not_finite:
      return "not finite";
  }
  return "unknown";
}

namespace detail {

PLATOON_VECTOR_CLONES
bool all_finite(const double* values, std::size_t count) {
  // Integer arithmetic, so that the loop vectorises: only an exponent of all ones carries into the top bit.
  std::uint64_t carry = 0;
  for (std::size_t j = 0; j < count; ++j) {
    std::uint64_t bits;
    std::memcpy(&bits, &values[j], sizeof bits);
    carry |= (bits & 0x7ff0000000000000ULL) + 0x0010000000000000ULL;
  }
  return (carry >> 63) == 0;
}

}  // namespace detail

bool all_finite(const std::vector<double>& values) {
  return detail::all_finite(values.data(), values.size());
}

// Whether it is the next turn of the present attempt.
bool Sequence::continues(const Turn& turn) const {
  if (schedule_.is_last_step(latest_->step)) {
    return turn.step == kInitialStep && turn.first_realization == schedule_.next(latest_->first_realization);
  }
  return turn.first_realization == latest_->first_realization && turn.step == latest_->step + 1;
}

Verdict Sequence::receive(const Turn& turn, const std::vector<double>& positions) {
  if (latest_ && turn.attempt < latest_->attempt) return Verdict::stale;
  const bool new_attempt = !latest_ || turn.attempt > latest_->attempt;
  if (new_attempt && turn.step != kInitialStep) return Verdict::missed_start;
  if (!new_attempt && !continues(turn)) return Verdict::out_of_turn;
  if (positions.empty() || positions.size() != schedule_.size(turn.first_realization))
    return Verdict::wrong_size;
  if (!all_finite(positions)) return Verdict::not_finite;
  latest_ = turn;
  return Verdict::in_turn;
}

}  // namespace platoon
