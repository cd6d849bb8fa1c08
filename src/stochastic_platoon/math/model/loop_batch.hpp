#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

struct ClosedLoop;

/// The control inputs of one step, of vehicles computed part by part.
struct ControlInputs {
  const double* heard = nullptr;  ///< the predecessor's, as received [m/s^2]; null: none
  double gain = 0.0;              ///< F, by which it is fed forward
  double* own = nullptr;          ///< output: u(k) [m/s^2]; null: not written

  /// The same from this realization on.
  PLATOON_INLINE ControlInputs from(std::size_t realization) const {
    return {heard == nullptr ? nullptr : heard + realization, gain, own == nullptr ? nullptr : own + realization};
  }
};

/// One vehicle's closed loop for a batch of realizations. Every realization undergoes the same operations in the same
/// order, so its bits do not depend on the batch.
class LoopBatch {
public:
  virtual ~LoopBatch() = default;

  /// Steady motion through y = p at these positions p [m], by `slope` per step [m]; 0: at rest.
  void start(const std::vector<double>& positions, double slope);

  /// One step with the input [m] minus offset [m]; writes y [m]. All arrays have the size of the batch. Control inputs
  /// are for loops by parts only.
  void step(const double* input, double offset, double* positions, const ControlInputs& control);

  /// y [m], resized to the batch.
  void output(std::vector<double>& positions) const;

protected:
  /// `equilibrium`: the states of y = 1 at rest. `ramp`: those of y(k) = k at k = 0. `places`: see place().
  LoopBatch(std::vector<double> equilibrium, std::vector<double> ramp, std::size_t places);

  std::size_t order() const { return equilibrium_.size(); }

  /// Number of steps since the start, modulo `places`: where a ring of states begins.
  std::size_t place() const { return place_; }

private:
  // The same for one tile, whose states follow one another at a distance of kTile.
  virtual void step_tile(double* state, std::size_t size, const double* input, double offset, double* positions,
                         const ControlInputs& control) = 0;
  virtual void output_tile(const double* state, std::size_t size, double* positions) const = 0;

  std::size_t tile_size(std::size_t first) const { return std::min(kTile, size_ - first); }

  std::vector<double> equilibrium_, ramp_;
  std::size_t places_, place_ = 0;
  std::size_t size_ = 0;  ///< realizations
  AlignedValues state_;   ///< tile by tile, state by state
};

/// The batch computation of the loop, by its parts if it has any, else by its realization. Throws std::invalid_argument
/// if it has no equilibrium.
std::unique_ptr<LoopBatch> loop_batch(const ClosedLoop& loop);

}  // namespace platoon
