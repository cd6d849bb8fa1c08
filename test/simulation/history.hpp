#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "simulation/world.hpp"

namespace platoon::simulation {

/// A run that ends for a reason that is no fault of a simulated thing.
class Failure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Failure for a problem that is not empty.
inline void require_none(const std::string& problem) {
  if (!problem.empty()) throw Failure(problem);
}

/// What happens in a world, with the times since this object was made.
class History {
public:
  explicit History(World& world) : world_(world), began_(world.now()) {}

  void note(const std::string& text);

  /// A line that a node prints. Throws Failure for a stall without a cause.
  void log(const std::string& line);

  /// Throws Failure soon: not within the callback of a node, which would end with the exception.
  void fail(const std::string& what);

  const std::vector<std::string>& lines() const { return lines_; }

private:
  World& world_;
  double began_;  ///< [s]
  std::vector<std::string> lines_;
};

}  // namespace platoon::simulation
