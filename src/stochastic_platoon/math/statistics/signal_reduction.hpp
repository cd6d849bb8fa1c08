#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/statistics/batch_moments.hpp"

namespace platoon {

struct FollowerSignals;
struct Signal;
struct SignalPositions;

/// Forms a signal of one follower at one step of a batch and reduces it, with the bits of reduce_batch(). The tracking
/// error is formed and reduced in one pass, four quarters of the realizations side by side.
std::vector<MomentNode> reduce_signal(std::uint64_t first_realization, const Signal& signal,
                                      const SignalPositions& positions, KeptMoments kept);

/// Destinations of the values of a step, one value per realization; null: not stored.
struct FormedValues {
  double* errors = nullptr;    ///< receives the tracking errors
  double* smallest = nullptr;  ///< lowered to the first requested signal wherever that is smaller
};

/// Reduces the requested signals of a follower at a step of one batch, step after step, with the bits of
/// reduce_signal(). Where two moments are kept, the gap and differences of order 1, 2 and 3 need one pass over the
/// positions, which forms the tracking errors, too: less than half the time of one signal after the other.
class SignalReduction {
public:
  SignalReduction(std::uint64_t first_realization, std::size_t count, KeptMoments kept);

  /// The nodes of every requested signal, one per range of the batch. The reference is valid until the next call, which
  /// reuses the storage.
  const std::vector<std::vector<MomentNode>>& reduce(const FollowerSignals& signals, const SignalPositions& positions,
                                                     const FormedValues& values);

  /// The least value of the first requested signal in the latest call that lowered smallest values.
  double least() const { return least_; }

private:
  using Places = std::array<std::size_t, kCellsAtOnce>;  ///< the signal of every order that is computed together
  void reduce_together(const FollowerSignals& signals, const Places& places, const SignalPositions& positions,
                       const FormedValues& values);

  void lower(const Signal& signal, const SignalPositions& positions, double* smallest);

  std::uint64_t first_realization_;
  std::vector<DyadicRange> ranges_;
  KeptMoments kept_;
  std::vector<std::vector<MomentNode>> nodes_;
  std::vector<double> first_values_;
  std::vector<double> unused_;  ///< receives values that are not requested
  double least_ = 0.0;
};

}  // namespace platoon
