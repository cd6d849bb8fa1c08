#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/channel/mode_chances.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "stochastic_platoon/math/numerics/multiples.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace detail {

// Replaces the position by the prediction if u is below the loss probability, and updates that probability.
PLATOON_VECTOR_CLONES
void lose(const double* uniforms, const double* predicted, double after_loss, double after_arrival, std::size_t size,
          double* chance, double* positions) {
  for (std::size_t r = 0; r < size; ++r) {
    const bool lost = uniforms[r] < chance[r];
    positions[r] = lost ? predicted[r] : positions[r];
    chance[r] = lost ? after_loss : after_arrival;
  }
}

// The same for independent losses: the probability is always q.
PLATOON_VECTOR_CLONES
void lose_independently(const double* uniforms, const double* predicted, double q, std::size_t size,
                        double* positions) {
  for (std::size_t r = 0; r < size; ++r) positions[r] = uniforms[r] < q ? predicted[r] : positions[r];
}

}  // namespace detail

namespace {

// Replaces the positions that a trace loses at this step, and advances to its next entry.
void lose_as_recorded(const LossTrace& trace, const double* predicted, std::size_t size, std::uint32_t* entry,
                      double* positions) {
  for (std::size_t r = 0; r < size; ++r) {
    if (trace.is_lost(entry[r])) positions[r] = predicted[r];
    entry[r] = entry[r] + 1 < trace.size() ? entry[r] + 1 : 0;
  }
}

class PacketLoss : public LinkStage {
public:
  PacketLoss(const LossModel& loss, const WhiteNoise& noise, std::uint32_t stream)
      : loss_(loss), draws_(noise), stream_(stream), used_(loss.predictor.size()) {
    if (!(loss.probability >= 0.0 && loss.probability < 1.0))
      throw std::invalid_argument("loss probability: " + std::to_string(loss.probability) +
                                  ": must be from 0 to below 1");
    if (loss.markov) modes_.emplace(LossChain(loss));
  }

  bool keeps_state() const override { return true; }

  void start(std::uint64_t first_realization, std::size_t count, double* positions, double slope) override {
    for (std::size_t j = 0; j < used_.size(); ++j) {
      used_[j].assign(positions, positions + count);
      if (slope == 0.0) continue;
      for (double& position : used_[j]) position -= slope * static_cast<double>(j);
    }
    chance_.assign(count, loss_.probability);
    newest_ = 0;
    mode_.assign(modes_ ? count : 0, 0);
    if (!loss_.trace) return;
    const auto entries = static_cast<double>(loss_.trace->size());
    draws_.fill_uniform({stream_, -1, Purpose::loss}, first_realization, count, chance_.data());
    entry_.resize(count);
    for (std::size_t r = 0; r < count; ++r) entry_[r] = static_cast<std::uint32_t>(entries * chance_[r]);
  }

  bool depends_on_gap() const override { return loss_.by_distance.has_value(); }

  void see_gaps(std::size_t count, const double* gaps) override {
    loss_.by_distance->probabilities(gaps, count, chance_.data());
  }

  void step(std::int64_t step, std::uint64_t first_realization, std::size_t count, double* positions) override {
    std::array<double, kTile> uniforms, predicted;
    const std::size_t n = used_.size(), oldest = n > 0 ? (newest_ + n - 1) % n : 0;
    for (std::size_t r = 0; r < count; r += kTile) {
      const std::size_t size = std::min(kTile, count - r);
      if (!loss_.trace)
        draws_.fill_uniform({stream_, step, Purpose::loss}, first_realization + r, size, uniforms.data());
      const double* guess = predicted.data();
      if (n == 0) {
        predicted.fill(0.0);
      } else if (n == 1) {
        guess = &used_[0][r];  // a single coefficient is 1: hold
      } else {
        set_multiple(loss_.predictor[0], &used_[newest_][r], size, predicted.data());
        for (std::size_t j = 1; j < n; ++j)
          add_multiple(loss_.predictor[j], &used_[(newest_ + j) % n][r], size, predicted.data());
      }
      if (loss_.trace) {
        lose_as_recorded(*loss_.trace, guess, size, &entry_[r], positions + r);
      } else if (modes_) {
        lose_by_modes(step, uniforms.data(), guess, size, &mode_[r], positions + r);
      } else if (loss_.mean_burst || loss_.by_distance) {
        detail::lose(uniforms.data(), guess, loss_.after_loss(), loss_.after_arrival(), size, &chance_[r],
                     positions + r);
      } else {
        detail::lose_independently(uniforms.data(), guess, loss_.probability, size, positions + r);
      }
      if (n > 0) std::copy_n(positions + r, size, &used_[oldest][r]);
    }
    newest_ = oldest;
  }

private:
  void lose_by_modes(std::int64_t step, const double* uniforms, const double* predicted, std::size_t size,
                     std::uint8_t* mode, double* positions) const {
    for (std::size_t r = 0; r < size; ++r) {
      mode[r] = step > 0 ? modes_->after(mode[r], uniforms[r]) : modes_->first(uniforms[r]);
      if (modes_->is_lost(mode[r])) positions[r] = predicted[r];
    }
  }

  LossModel loss_;
  WhiteNoise draws_;
  std::uint32_t stream_;
  std::vector<AlignedValues> used_;  ///< ring of r(k-1), r(k-2), ... from newest_ on, per realization
  std::size_t newest_ = 0;
  AlignedValues chance_;              ///< probability of a loss at the next step, per realization
  std::optional<ModeChances> modes_;  ///< of losses by the states of a chain
  std::vector<std::uint8_t> mode_;    ///< of the chain at the latest step, per realization
  std::vector<std::uint32_t> entry_;  ///< of the trace at the next step, per realization
};

}  // namespace

std::unique_ptr<LinkStage> packet_loss(const LossModel& loss, const WhiteNoise& noise, std::uint32_t stream) {
  return std::make_unique<PacketLoss>(loss, noise, stream);
}

}  // namespace platoon
