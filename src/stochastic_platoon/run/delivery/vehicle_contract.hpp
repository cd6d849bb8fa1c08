#pragma once

#include <array>
#include <optional>
#include <string>

#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// What vehicle i has to keep to, whoever provides it: msg/README.md. In the order in which check_vehicle comes to
/// them, numbered from 1.
enum class Clause {
  one_publisher,
  answer,
  size,
  finite,
  stamp,
  turn,
  attempt,
  start_anew,
  causal,
  queues,
  run,
};
constexpr std::size_t kClauses = 11;

/// All of them, in order.
constexpr std::array<Clause, kClauses> kVehicleContract{
    Clause::one_publisher, Clause::answer,     Clause::size,   Clause::finite, Clause::stamp, Clause::turn,
    Clause::attempt,       Clause::start_anew, Clause::causal, Clause::queues, Clause::run};

/// Its sentence: "One node publishes vehicle_i/position."
const char* to_string(Clause clause);

/// "clause 4 of the vehicle contract: ..." with its sentence.
std::string named(Clause clause);

/// The clause that a vehicle breaks whose message is dropped for this reason; none of one that is in turn or stale.
std::optional<Clause> broken_clause(DropReason drop);

}  // namespace platoon
