#pragma once

#include <algorithm>
#include <boost/align/aligned_allocator.hpp>
#include <cstddef>
#include <memory>
#include <vector>

namespace platoon {

struct ClosedLoop;

/// Realizations per tile: the states of one vehicle for a tile fit in the first level cache.
constexpr std::size_t kTile = 512;

/// 64-byte aligned, as a load across two cache lines costs two.
using AlignedValues = std::vector<double, boost::alignment::aligned_allocator<double, 64>>;

/// The control inputs of one step, of vehicles computed part by part.
struct ControlInputs {
  const double* heard = nullptr;  ///< the predecessor's, as received [m/s^2]; null: none
  double gain = 0.0;              ///< F, by which it is fed forward
  double* own = nullptr;          ///< output: u(k) [m/s^2]; null: not written
};

/// One vehicle's closed loop for a batch of realizations.
class LoopBatch {
public:
  virtual ~LoopBatch() = default;

  /// Equilibrium with y = p at these positions p [m].
  virtual void start_at_equilibrium(const std::vector<double>& positions) = 0;

  /// One step with the input [m] minus offset [m]; writes y [m]. All arrays have the size of the batch. Control inputs
  /// are for loops by parts only.
  virtual void step(const double* input, double offset, double* positions, const ControlInputs& control) = 0;
  void step(const double* input, double offset, double* positions) { step(input, offset, positions, {}); }

  /// y [m], resized to the batch.
  virtual void output(std::vector<double>& positions) const = 0;
};

/// The batch computation of the loop, by its parts if it has any, else by its realization. Throws std::invalid_argument
/// if it has no equilibrium.
std::unique_ptr<LoopBatch> loop_batch(const ClosedLoop& loop);

}  // namespace platoon
