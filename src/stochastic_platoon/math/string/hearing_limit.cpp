#include "stochastic_platoon/math/string/hearing_limit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/krylov.hpp"

namespace platoon {

namespace {

using Window = HearingSpectra::Window;
// A loss gain of which only the side of 1 counts is known to this share of its distance from 1.
constexpr double kShareOfDistance = 0.01;

using SpectralMatrix = std::vector<std::vector<Eigen::ArrayXcd>>;  // entries per frequency

SpectralMatrix product(const SpectralMatrix& a, const SpectralMatrix& b) {
  const std::size_t r = a.size();
  SpectralMatrix c(r, std::vector<Eigen::ArrayXcd>(r, Eigen::ArrayXcd::Zero(a[0][0].size())));
  for (std::size_t i = 0; i < r; ++i) {
    for (std::size_t j = 0; j < r; ++j) {
      for (std::size_t l = 0; l < r; ++l) c[i][j] += a[i][l] * b[l][j];
    }
  }
  return c;
}

SpectralMatrix adjoint(const SpectralMatrix& a) {
  SpectralMatrix c = a;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < a.size(); ++j) c[i][j] = a[j][i].conjugate();
  }
  return c;
}

/// Adds to the first frequencies of the sum.
void add_to(SpectralMatrix& sum, const SpectralMatrix& a) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < a.size(); ++j) sum[i][j].head(a[i][j].size()) += a[i][j];
  }
}

SpectralMatrix head(const SpectralMatrix& a, Eigen::Index frequencies) {
  SpectralMatrix c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (const Eigen::ArrayXcd& entry : a[i]) c[i].emplace_back(entry.head(frequencies));
  }
  return c;
}

/// The number of frequencies up to the last one at which an entry is larger than this.
Eigen::Index above(double size, const SpectralMatrix& a) {
  Eigen::Index last = 0;
  for (const auto& row : a) {
    for (const Eigen::ArrayXcd& entry : row) {
      Eigen::Index k = entry.size();
      while (k > last && !(std::norm(entry(k - 1)) > size * size)) --k;
      last = k;
    }
  }
  return last;
}

/// An endless string in which place p of the pattern adds a given spectrum.
class EndlessString {
public:
  explicit EndlessString(const HearingSpectra& spectra, std::size_t period)
      : spectra_(spectra), period_(period), first_(spectra.reach() + 1) {
    // Whole patterns later, so that first_ begins one.
    while ((first_ - 1) % period_ != 0) ++first_;
    const Window nothing = spectra.nothing();
    SpectralMatrix product_of_all = nothing;
    for (std::size_t j = 0; j < product_of_all.size(); ++j) product_of_all[j][j].setOnes();
    for (std::size_t p = 0; p < period_; ++p) {
      SpectralMatrix companion = nothing;
      companion[0] = spectra.transfers(first_ + p);
      for (std::size_t j = 1; j < companion.size(); ++j) companion[j][j - 1].setOnes();
      product_of_all = product(companion, product_of_all);
    }
    const Eigen::ArrayXd zero = Eigen::ArrayXd::Zero(nothing[0][0].size());
    for (std::size_t p = 0; p < period_; ++p) {
      Window once = nothing;
      for (std::size_t q = 0; q < period_; ++q) spectra.advance(first_ + q, q == p ? zero + 1.0 : zero, once);
      of_one_.push_back(std::move(once));
    }
    constexpr double kNegligible = 1e-20;
    SpectralMatrix power = std::move(product_of_all);
    for (int doubling = 0; doubling < 60; ++doubling) {
      check_interruption();
      const Eigen::Index left = above(kNegligible, power);  // the lowest frequencies decay last
      if (left == 0) break;
      power = head(power, left);
      const SpectralMatrix turned = adjoint(power);
      for (Window& window : of_one_) add_to(window, product(product(power, head(window, left)), turned));
      power = product(power, power);
    }
  }

  /// The window in front of the first place: X = M X M* + Q, linear in what each place adds.
  Window in_front(const std::vector<Eigen::ArrayXd>& added) const {
    Window window = spectra_.nothing();
    for (std::size_t p = 0; p < period_; ++p) {
      for (std::size_t i = 0; i < window.size(); ++i) {
        for (std::size_t j = 0; j < window.size(); ++j) window[i][j] += added[p] * of_one_[p][i][j];
      }
    }
    return window;
  }

  HearingWalk walk_behind(Window window) const { return HearingWalk(spectra_, first_, std::move(window)); }

  /// The variances of the tracking errors at the places, and the spectra that each adds behind this window.
  std::vector<double> pass(Window window, const std::vector<Eigen::ArrayXd>& added,
                           std::vector<Eigen::ArrayXd>& next) const {
    HearingWalk walk = walk_behind(std::move(window));
    std::vector<double> variances;
    for (std::size_t p = 0; p < period_; ++p) {
      next[p] = sum_of(walk.added());
      walk.pass(added[p]);
      variances.push_back(walk.error_variance());
    }
    return variances;
  }

  std::vector<Eigen::ArrayXd> of_noise() const {
    std::vector<Eigen::ArrayXd> added;
    for (std::size_t p = 0; p < period_; ++p) added.push_back(sum_of(spectra_.added(first_ + p, spectra_.nothing())));
    return added;
  }

private:
  const HearingSpectra& spectra_;
  std::size_t period_, first_;
  std::vector<Window> of_one_;  ///< in front, if a place alone adds 1; by doubling
};

/// What losses add behind given added spectra of all places, as one vector: a map whose spectral radius is the loss
/// gain.
class LossRound {
public:
  explicit LossRound(const EndlessString& string) : string_(string), noise_(string.of_noise()) {}

  Eigen::Index size() const { return static_cast<Eigen::Index>(noise_.size()) * noise_.front().size(); }

  Eigen::VectorXd operator()(const Eigen::VectorXd& added) const {
    std::vector<Eigen::ArrayXd> next = noise_;
    variances(added, next);
    for (std::size_t p = 0; p < next.size(); ++p) next[p] -= noise_[p];
    return joined(next);
  }

  /// The variances of the tracking errors at the places.
  std::vector<double> variances(const Eigen::VectorXd& added) const {
    std::vector<Eigen::ArrayXd> next = noise_;
    return variances(added, next);
  }

  Eigen::VectorXd noise() const { return joined(noise_); }

  /// The parts of such a vector.
  std::vector<Eigen::ArrayXd> at_places(const Eigen::VectorXd& added) const {
    std::vector<Eigen::ArrayXd> parts;
    for (std::size_t p = 0; p < noise_.size(); ++p)
      parts.emplace_back(added.segment(static_cast<Eigen::Index>(p) * noise_[p].size(), noise_[p].size()));
    return parts;
  }

private:
  std::vector<double> variances(const Eigen::VectorXd& added, std::vector<Eigen::ArrayXd>& next) const {
    const std::vector<Eigen::ArrayXd> parts = at_places(added);
    return string_.pass(string_.in_front(parts), parts, next);
  }

  Eigen::VectorXd joined(const std::vector<Eigen::ArrayXd>& spectra) const {
    Eigen::VectorXd all(size());
    for (std::size_t p = 0; p < spectra.size(); ++p)
      all.segment(static_cast<Eigen::Index>(p) * spectra[p].size(), spectra[p].size()) = spectra[p];
    return all;
  }

  const EndlessString& string_;
  std::vector<Eigen::ArrayXd> noise_;
};

}  // namespace

LossGain hearing_loss_gain(const HearingSpectra& spectra, std::size_t period) {
  const EndlessString string(spectra, period);
  const LossRound round(string);
  return {perron_root_beside_one(round, round.size(), kShareOfDistance),
          round.variances(Eigen::VectorXd::Ones(round.size())).front()};
}

HearingWalk walk_behind_endless(const HearingSpectra& spectra, std::size_t period, bool loses) {
  const EndlessString string(spectra, period);
  if (!loses) return string.walk_behind(string.in_front(string.of_noise()));
  const LossRound round(string);
  return string.walk_behind(string.in_front(round.at_places(solve_one_minus(round, round.noise()))));
}

StringEnd hearing_limit(const HearingSpectra& spectra, std::size_t period, bool loses) {
  const EndlessString string(spectra, period);
  const LossRound round(string);
  if (!loses) return {round.variances(round.noise()), 0.0};
  const double gain = perron_root(round, round.size());
  if (gain >= 1.0) return {std::vector<double>(period, 0.0), gain};
  return {round.variances(solve_one_minus(round, round.noise())), gain};
}

}  // namespace platoon
