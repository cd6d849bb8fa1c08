#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"

namespace platoon {

const char* to_string(Clause clause) {
  switch (clause) {
    case Clause::one_publisher:
      return "One node publishes vehicle_i/position.";
    case Clause::answer:
      return "It answers every message in turn with its own position at that step.";
    case Clause::run:
      return "Its answer carries the message's run; a step -1 of another run begins that run, and nothing else of another run is answered.";
    case Clause::turn:
      return "It publishes every step of a batch once, from -1 on, and nothing on a message out of turn.";
    case Clause::size:
      return "It publishes as many positions as the message has.";
    case Clause::finite:
      return "Its positions are finite numbers.";
    case Clause::stamp:
      return "Its answer carries the stamp of the message of the same step.";
    case Clause::attempt:
      return "A newer attempt begins at its step -1, and nothing of an older one is answered.";
    case Clause::start_anew:
      return "On step -1 it stands at its initial position and has forgotten everything: the same messages, the same positions.";
    case Clause::causal:
      return "Its position at a step depends on the messages before that step only.";
    case Clause::spacing:
      return "It keeps the run's standstill distance delta and headway h: behind a predecessor that drives v per step, the distance settles at delta + h v.";
    case Clause::queues:
      return "Its queues drop nothing: unbounded, with tcpNoDelay.";
  }
  return "unknown";
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
