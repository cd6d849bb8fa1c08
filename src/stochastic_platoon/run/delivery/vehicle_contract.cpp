#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"

namespace platoon {

const char* to_string(Clause clause) {
  static constexpr std::array<const char*, kVehicleContract.size()> kSentences{
      "One node publishes vehicle_i/position.",
      "It answers every message in turn with its own position at that step.",
      "It publishes as many positions as the message has.",
      "Its positions are finite numbers.",
      "Its answer carries the stamp of the message of the same step.",
      "It publishes every step of a batch once, from -1 on, and nothing on a message out of turn.",
      "A newer attempt begins at its step -1, and nothing of an older one is answered.",
      "On step -1 it is at its initial position, at rest or steadily at the speed V, and has forgotten everything: the same messages, the same positions.",
      "Its position at a step depends on the messages before that step only.",
      "Its queues drop nothing: unbounded, with tcpNoDelay.",
      "Its answer carries the message's run; a step -1 of another run begins that run, and nothing else of another run is answered.",
      "It keeps the run's standstill distance delta and headway h: behind a predecessor that drives v per step, the distance settles at delta + h v. A steady start begins there, with v = V T_s.",
  };
  return kSentences[static_cast<std::size_t>(clause)];
}

std::string named(Clause clause) {
  return "clause " + std::to_string(static_cast<int>(clause) + 1) + " of the vehicle contract: " + to_string(clause);
}

std::optional<Clause> broken_clause(DropReason drop) {
  switch (drop) {
    case DropReason::none:
    case DropReason::stale:
      return std::nullopt;
    case DropReason::missed_start:
      return Clause::attempt;
    case DropReason::out_of_turn:
      return Clause::turn;
    case DropReason::wrong_size:
      return Clause::size;
    case DropReason::not_finite:
      return Clause::finite;
    case DropReason::foreign_run:
      return Clause::run;
  }
  return std::nullopt;
}

}  // namespace platoon
