#pragma once

#include <array>
#include <optional>
#include <string>

#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// The clauses that vehicle i must satisfy, built-in or external; see msg/README.md. Numbered from 1, in the order in
/// which check_vehicle tests them.
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
  spacing,
};

/// All clauses, in order.
constexpr std::array<Clause, 12> kVehicleContract{
    Clause::one_publisher, Clause::answer,     Clause::size,   Clause::finite, Clause::stamp, Clause::turn,
    Clause::attempt,       Clause::start_anew, Clause::causal, Clause::queues, Clause::run,   Clause::spacing};

/// The clause's sentence: "One node publishes vehicle_i/position."
const char* to_string(Clause clause);

/// "clause 4 of the vehicle contract: ..." with the clause's sentence.
std::string named(Clause clause);

/// The clause that a vehicle violates if its message is dropped for this reason; none for a message in turn or stale.
std::optional<Clause> broken_clause(DropReason drop);

}  // namespace platoon
