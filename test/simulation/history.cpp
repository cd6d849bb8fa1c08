#include "simulation/history.hpp"

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon::simulation {

void History::note(const std::string& text) {
  lines_.push_back(formatted("%.6f ", world_.now() - began_) + text);
}

void History::log(const std::string& line) {
  note(line);
  const std::size_t stall = line.find("run stalled: ");
  if (stall == std::string::npos) return;
  const std::string cause = line.substr(stall + 13);
  const bool is_named = cause.find("vehicle_") != std::string::npos || cause.find("recorder") != std::string::npos ||
                        cause.find("vehicles are not running") != std::string::npos;
  if (!is_named) throw Failure("a stall without a cause: " + line);
}

void History::fail(const std::string& what) {
  world_.after(0.0, nullptr, [what] { throw Failure(what); });
}

}  // namespace platoon::simulation
