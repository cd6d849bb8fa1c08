#include "stochastic_platoon/run/delivery/message_order.hpp"

#include <array>
#include <tuple>

namespace platoon {

const char* to_string(DropReason drop) {
  static constexpr std::array<const char*, kDropReasons> kTexts{
      "in turn",    "stale",         "of an attempt whose start was missed", "out of turn", "of a wrong batch size",
      "not finite", "of another run"};
  return kTexts[static_cast<std::size_t>(drop)];
}

// True for the next message of the present attempt.
bool MessageOrder::continues(const MessageId& id) const {
  if (schedule_.is_last_step(latest_->step)) {
    return id.step == kInitialStep && id.first_realization == schedule_.next(latest_->first_realization);
  }
  return id.first_realization == latest_->first_realization && id.step == latest_->step + 1;
}

bool MessageOrder::has_missed(DropReason drop, const MessageId& id, std::int64_t first_loss) const {
  if (!may_be_reported(schedule_, id)) return false;  // the run has no such message
  if (drop == DropReason::missed_start) return id.step >= first_loss;
  return drop == DropReason::out_of_turn && latest_ && id.attempt == latest_->attempt &&
         std::tie(id.first_realization, id.step) > std::tie(latest_->first_realization, latest_->step);
}

DropReason MessageOrder::receive(const MessageDescriptor& descriptor) {
  const MessageId& id = descriptor.id;
  if (id.attempt > kLastAttempt) return DropReason::out_of_turn;
  if (latest_ && id.attempt < latest_->attempt) return DropReason::stale;
  const bool new_attempt = !latest_ || id.attempt > latest_->attempt;
  if (new_attempt && id.step != kInitialStep) return DropReason::missed_start;
  if (!new_attempt && !continues(id)) return DropReason::out_of_turn;
  if (descriptor.size == 0 || descriptor.size != schedule_.size(id.first_realization)) return DropReason::wrong_size;
  if (!descriptor.finite) return DropReason::not_finite;
  latest_ = id;
  return DropReason::none;
}

}  // namespace platoon
