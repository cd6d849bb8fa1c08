#include "stochastic_platoon/math/string/linked_string.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/links/loss_operator.hpp"
#include "stochastic_platoon/math/links/settled_spectra.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

/// The spectrum that the losses of a link scatter from one that is sent.
Eigen::ArrayXd scattered(const LossScatter& losses, const Eigen::ArrayXd& sent) {
  return losses(losses.drives(sent.matrix()));
}

/// What a link adds to the spectrum of its vehicle's position at this speed, without the part scattered from the
/// predecessor's.
Eigen::ArrayXd constant_part(const StringSpectra::Input& input, double speed) {
  Eigen::ArrayXd added = input.passed * input.noise;
  if (!input.losses) return added;
  Eigen::ArrayXd of_losses = scattered(*input.losses, input.noise);
  const double constant_drive = speed * input.losses->slope();
  if (speed != 0.0) of_losses += constant_drive * constant_drive * input.losses->of_constant_drive();
  return added + input.own * of_losses;
}

std::vector<Eigen::ArrayXd> constant_parts(const StringSpectra::Type& type, double speed) {
  std::vector<Eigen::ArrayXd> parts;
  for (const StringSpectra::Input& input : type.inputs)
    parts.push_back(constant_part(input, parts.empty() ? speed : 0.0));
  return parts;
}

/// A walk where vehicles hear their predecessors.
class LinkedWalk : public StringWalk {
public:
  /// From the leader on; `speed` in metres per step.
  LinkedWalk(const StringSpectra& spectra, double speed)
      : spectra_(&spectra), speed_(speed), behind_leader_(true), spectrum_(Eigen::ArrayXd::Zero(spectra.nodes())) {}

  /// From the first place of a pattern on, behind a position with this spectrum.
  LinkedWalk(const StringSpectra& spectra, double speed, Eigen::ArrayXd ahead)
      : spectra_(&spectra), speed_(speed), behind_leader_(false), spectrum_(std::move(ahead)) {}

  std::unique_ptr<StringWalk> clone() const override { return std::make_unique<LinkedWalk>(*this); }

  std::vector<Eigen::ArrayXd> added() override {
    const StringSpectra& spectra = *spectra_;
    const StringSpectra::Type& type = spectra[next_];
    const std::size_t index = spectra.type(next_);
    if (index >= constant_.size()) constant_.resize(index + 1);
    if (constant_[index].empty()) constant_[index] = constant_parts(type, speed_);
    std::vector<Eigen::ArrayXd> added = constant_[index];
    for (std::size_t link = 0; link < added.size() && !behind_leader_; ++link) {
      const StringSpectra::Input& input = type.inputs[link];
      if (input.losses) added[link] += input.own * scattered(*input.losses, spectra.at_link(next_, link, spectrum_));
    }
    return added;
  }

  void pass(Eigen::ArrayXd added) override {
    check_interruption();
    before_.swap(spectrum_);
    spectrum_ = (*spectra_)[next_].gain * before_ + added;
    added_ = std::move(added);
    behind_leader_ = false;
    ++next_;
  }

  double error_variance() const override { return spectra_->error_variance(next_ - 1, before_, added_); }

  std::array<double, 2> moments(const Signal& signal) const override {
    if (signal.is_relative() && signal.own.order > 0) throw std::logic_error("two terms: need cross spectra");
    Eigen::ArrayXd spectrum = spectrum_;
    if (signal.is_relative()) spectrum = (*spectra_)[next_ - 1].of_gap * before_ + added_;
    const Signal::Term& term = signal.is_relative() ? signal.apart : signal.own;
    for (int n = 0; n < term.order; ++n) spectrum *= 2.0 * spectra_->from_one();
    spectrum *= term.factor * term.factor;
    return {spectra_->mean(spectrum), 2.0 * spectra_->mean(spectra_->from_one() * spectrum)};
  }

private:
  const StringSpectra* spectra_;
  double speed_;
  bool behind_leader_;  ///< whose position has no spectrum
  std::size_t next_ = 0;
  Eigen::ArrayXd spectrum_;                            ///< in front of the next follower
  Eigen::ArrayXd before_, added_;                      ///< in front of the last one, and what it added
  std::vector<std::vector<Eigen::ArrayXd>> constant_;  ///< per type: what its inputs add at the leader
};

/// The endless string of vehicles that hear their predecessors, by the LossOperator of its links.
class EndlessLinked : public EndlessString {
public:
  EndlessLinked(const StringSpectra& spectra, double speed)
      : EndlessString(spectra.size(), spectra.nodes()), spectra_(spectra), speed_(speed), losses_(spectra) {}

  std::vector<Eigen::ArrayXd> noise() const override {
    std::vector<Eigen::ArrayXd> added;
    for (std::size_t j = 0; j < spectra_.size(); ++j) added.push_back(sum_of(constant_parts(spectra_[j], speed_)));
    return added;
  }

  Eigen::Index dimensions() const override { return losses_.dimensions(); }
  Eigen::VectorXd drives(const std::vector<Eigen::ArrayXd>& added) const override { return losses_.drives(added); }
  void add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const override {
    losses_.add(drives, added);
  }
  std::unique_ptr<StringWalk> walk_behind(const std::vector<Eigen::ArrayXd>& added) const override {
    return std::make_unique<LinkedWalk>(spectra_, speed_, spectra_.in_front(added, losses_.margin()));
  }

private:
  const StringSpectra& spectra_;
  double speed_;
  LossOperator losses_;
};

}  // namespace

std::vector<double> LinkedTheory::means(std::size_t followers) const {
  std::vector<double> means(followers, kNaN);
  if (!mean_square_stable()) return means;
  for (std::size_t i = 0; i < followers; ++i) means[i] = metres_per_step(model()) * pattern_[i].lag();
  return means;
}

std::vector<double> LinkedTheory::gains(const std::vector<double>& frequencies) const {
  std::vector<double> gains;
  for (const double w : frequencies) {
    double product = 1.0;
    for (std::size_t i = 0; i < pattern_.size(); ++i) product *= pattern_[i].at(w).gain;
    gains.push_back(std::sqrt(product));
  }
  return gains;
}

JudgedGain LinkedTheory::judged_gain() const {
  const PatternGain gain = pattern_.gain();
  const LeastMargin least = gain.least();
  if (least.sign == Sign::kBelow) {
    const PatternGain::Peak peak = gain.peak();
    return {least.sign, peak.excess, peak.frequency};
  }
  JudgedGain judged{least.sign, 0.0, 0.0, least.sign == Sign::kZero && gain.is_one()};
  if (least.sign == Sign::kZero && !judged.is_one) judged.frequency = least.frequency;
  judged.grows_at_zero = least.sign == Sign::kAbove && pattern_.grows_at_zero(gain);
  return judged;
}

StringEnd LinkedTheory::end(bool with_variances) const {
  StringEnd end;
  end.doubt = pattern_.has_memory() ? 1e-11 : 1e-12;
  if (pattern_.has_losses()) {
    const auto gain = [](const StringSpectra& spectra) {
      return std::vector<double>{EndlessLinked(spectra, 0.0).loss_gain()};
    };
    end.loss_gain = settled_values(pattern_, std::nullopt, gain).front();
  }
  if (!with_variances || end.loss_gain >= 1.0 || end.is_undecided()) return end;
  end.variances = settled_values(pattern_, std::nullopt, [this](const StringSpectra& spectra) {
    const EndlessLinked string(spectra, metres_per_step(model()));
    return string.variances(string.added());
  });
  return end;
}

double LinkedTheory::loss_gain_beside_one() const {
  constexpr double kShare = 1e-4;  // accuracy of the distance from 1
  if (!pattern_.has_losses()) return 0.0;
  return settled_beside_one(pattern_, [this](const StringSpectra& spectra) {
    return EndlessLinked(spectra, 0.0).loss_gain_beside_one(pattern_.has_memory() ? kShare : 0.0);
  });
}

std::vector<double> LinkedTheory::settled(std::size_t followers, const Values& values) const {
  return settled_values(pattern_, followers, [&](const StringSpectra& spectra) {
    LinkedWalk walk(spectra, metres_per_step(model()));
    return values(walk);
  });
}

std::vector<double> LinkedTheory::settled_behind_endless(const Values& values) const {
  return settled_values(pattern_, std::nullopt, [&](const StringSpectra& spectra) {
    const EndlessLinked string(spectra, metres_per_step(model()));
    return values(*string.walk_behind(string.added()));
  });
}

}  // namespace platoon
