#include "stochastic_platoon/delivery/message_order.hpp"

#include <tuple>

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
    case Verdict::foreign_run:
      return "of another run";
  }
  return "unknown";
}

// Whether it is the next message of the present attempt.
bool MessageOrder::continues(const MessageId& id) const {
  if (schedule_.is_last_step(latest_->step)) {
    return id.step == kInitialStep && id.first_realization == schedule_.next(latest_->first_realization);
  }
  return id.first_realization == latest_->first_realization && id.step == latest_->step + 1;
}

bool MessageOrder::has_missed(Verdict verdict, const MessageId& id, std::int64_t first_loss) const {
  if (!may_be_reported(schedule_, id)) return false;  // there is no such message
  if (verdict == Verdict::missed_start) return id.step >= first_loss;
  return verdict == Verdict::out_of_turn && latest_ && id.attempt == latest_->attempt &&
         std::tie(id.first_realization, id.step) > std::tie(latest_->first_realization, latest_->step);
}

Verdict MessageOrder::receive(const Heading& heading) {
  const MessageId& id = heading.id;
  if (latest_ && id.attempt < latest_->attempt) return Verdict::stale;
  const bool new_attempt = !latest_ || id.attempt > latest_->attempt;
  if (new_attempt && id.step != kInitialStep) return Verdict::missed_start;
  if (!new_attempt && !continues(id)) return Verdict::out_of_turn;
  if (heading.size == 0 || heading.size != schedule_.size(id.first_realization)) return Verdict::wrong_size;
  if (!heading.finite) return Verdict::not_finite;
  latest_ = id;
  return Verdict::in_turn;
}

}  // namespace platoon
