#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace platoon {

/// Recorded arrivals and losses of a link: one entry per step, repeated periodically.
class LossTrace {
public:
  static constexpr std::size_t kLongest = 100'000'000;

  /// Throws std::invalid_argument for an empty trace, one longer than kLongest, or one without an arrival.
  explicit LossTrace(std::vector<bool> received);

  /// The inverse of runs(). Throws std::invalid_argument unless the text holds such numbers.
  static LossTrace of_runs(const std::string& runs);

  std::size_t size() const { return lost_.size(); }
  bool is_lost(std::size_t step) const { return lost_[step] != 0; }

  double probability() const { return probability_; }  ///< share of the entries that are losses
  double mean_burst() const { return mean_burst_; }    ///< mean length of a run of losses [steps]; 1 without any

  /// Lengths of the runs of arrivals and losses in turn, from the first entry on: "12 3 40 1" for 12 arrivals, 3
  /// losses, 40 arrivals and a loss; "0 ..." for a trace that begins with a loss.
  std::string runs() const;

  bool operator==(const LossTrace& other) const { return lost_ == other.lost_; }

private:
  std::vector<std::uint8_t> lost_;
  double probability_ = 0.0, mean_burst_ = 1.0;
};

}  // namespace platoon
