#include "stochastic_platoon/math/string/hearing_limit.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Window = HearingSpectra::Window;
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

void add_to(SpectralMatrix& sum, const SpectralMatrix& a) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < a.size(); ++j) sum[i][j] += a[i][j];
  }
}

double size_of(const SpectralMatrix& a) {
  double largest = 0.0;
  for (const auto& row : a) {
    for (const Eigen::ArrayXcd& entry : row) largest = std::max(largest, entry.abs().maxCoeff());
  }
  return largest;
}

/// An endless string in which place p of the pattern adds a given spectrum.
class EndlessString {
public:
  explicit EndlessString(const HearingSpectra& spectra, std::size_t period)
      : spectra_(spectra), period_(period), first_(spectra.reach() + 1) {
    // Whole patterns later, so that first_ begins one.
    while ((first_ - 1) % period_ != 0) ++first_;
    const Window nothing = spectra.nothing();
    product_ = nothing;
    for (std::size_t j = 0; j < product_.size(); ++j) product_[j][j].setOnes();
    for (std::size_t p = 0; p < period_; ++p) {
      SpectralMatrix companion = nothing;
      companion[0] = spectra.transfers(first_ + p);
      for (std::size_t j = 1; j < companion.size(); ++j) companion[j][j - 1].setOnes();
      product_ = product(companion, product_);
    }
  }

  /// The window in front of the first place: X = M X M* + Q, by doubling.
  Window in_front(const std::vector<Eigen::ArrayXd>& added) const {
    Window once = spectra_.nothing();
    for (std::size_t p = 0; p < period_; ++p) spectra_.advance(first_ + p, added[p], once);
    SpectralMatrix power = product_;
    for (int doubling = 0; doubling < 60 && size_of(power) > 1e-20; ++doubling) {
      check_interruption();
      add_to(once, product(product(power, once), adjoint(power)));
      power = product(power, power);
    }
    return once;
  }

  /// The variances at the places, and the spectra that each adds behind this window.
  std::vector<double> pass(Window window, const std::vector<Eigen::ArrayXd>& added,
                           std::vector<Eigen::ArrayXd>& next) const {
    std::vector<double> variances;
    for (std::size_t p = 0; p < period_; ++p) {
      next[p] = spectra_.added(first_ + p, window);
      variances.push_back(spectra_.error_variance(first_ + p, spectra_.advance(first_ + p, added[p], window)));
    }
    return variances;
  }

  std::vector<Eigen::ArrayXd> of_noise() const {
    std::vector<Eigen::ArrayXd> added;
    for (std::size_t p = 0; p < period_; ++p) added.push_back(spectra_.added(first_ + p, spectra_.nothing()));
    return added;
  }

private:
  const HearingSpectra& spectra_;
  std::size_t period_, first_;
  SpectralMatrix product_;
};

/// The largest factor by which what losses add grows from one round of the string to the next, by power iteration.
double loss_gain_of(const EndlessString& string, const std::vector<Eigen::ArrayXd>& noise) {
  constexpr int kMostRounds = 300;
  std::vector<Eigen::ArrayXd> added(noise.size(), Eigen::ArrayXd::Ones(noise.front().size())), next = added;
  double gain = 0.0;
  for (int round = 0; round < kMostRounds; ++round) {
    string.pass(string.in_front(added), added, next);
    double size = 0.0;
    for (std::size_t p = 0; p < next.size(); ++p) {
      next[p] -= noise[p];
      size = std::max(size, next[p].abs().maxCoeff());
    }
    if (!(size > 0.0) || !std::isfinite(size)) return size;
    for (std::size_t p = 0; p < next.size(); ++p) added[p] = next[p] / size;
    if (round > 0 && std::abs(size - gain) <= 1e-11 * size) return size;
    gain = size;
  }
  return gain;
}

}  // namespace

HearingLimit hearing_limit(const HearingSpectra& spectra, std::size_t period, bool loses) {
  constexpr int kMostRounds = 3000;
  const EndlessString string(spectra, period);
  const std::vector<Eigen::ArrayXd> noise = string.of_noise();
  std::vector<Eigen::ArrayXd> added = noise, next = noise;
  if (!loses) return {string.pass(string.in_front(added), added, next), 0.0};
  HearingLimit limit{std::vector<double>(period, 0.0), loss_gain_of(string, noise)};
  for (int round = 0; round < kMostRounds && limit.loss_gain < 1.0; ++round) {
    limit.variances = string.pass(string.in_front(added), added, next);
    double change = 0.0, largest = 0.0;
    for (std::size_t p = 0; p < period; ++p) {
      change = std::max(change, (next[p] - added[p]).abs().maxCoeff());
      largest = std::max(largest, next[p].maxCoeff());
    }
    added = next;
    if (change <= 1e-13 * largest) break;
  }
  return limit;
}

}  // namespace platoon
