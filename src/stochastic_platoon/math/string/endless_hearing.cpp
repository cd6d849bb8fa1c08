#include "stochastic_platoon/math/string/endless_hearing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Adds to frequencies of the sum, from this one on.
void add_to(SpectralMatrix& sum, Eigen::Index from, const SpectralMatrix& a) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < a.size(); ++j) sum[i][j].segment(from, a[i][j].size()) += a[i][j];
  }
}

SpectralMatrix part(const SpectralMatrix& a, Eigen::Index from, Eigen::Index frequencies) {
  SpectralMatrix c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (const Eigen::ArrayXcd& entry : a[i]) c[i].emplace_back(entry.segment(from, frequencies));
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

class EndlessHearing : public EndlessString {
public:
  EndlessHearing(const HearingSpectra& spectra, std::size_t period, std::size_t first)
      : EndlessString(period, spectra.moved().size()), spectra_(spectra), period_(period), first_(first) {
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
    constexpr Eigen::Index kBlock = 256;  // frequencies that stay in the cache
    for (Eigen::Index from = 0; from < zero.size(); from += kBlock)
      add_repetitions(from, part(product_of_all, from, std::min(kBlock, zero.size() - from)));
  }

  std::vector<Eigen::ArrayXd> noise() const override {
    std::vector<Eigen::ArrayXd> added;
    for (std::size_t p = 0; p < period_; ++p) added.push_back(sum_of(spectra_.added(first_ + p, spectra_.nothing())));
    return added;
  }

  Eigen::Index dimensions() const override {
    Eigen::Index sum = 0;
    for (std::size_t p = 0; p < period_; ++p) {
      const HearingSpectra::Vehicle& own = spectra_.vehicle(first_ + p);
      for (const auto& packet : own.packets) sum += spectra_.dimensions(own, packet);
    }
    return sum;
  }

  Eigen::VectorXd drives(const std::vector<Eigen::ArrayXd>& added) const override {
    Window window = in_front(added);
    Eigen::VectorXd drives(dimensions());
    Eigen::Index at = 0;
    for (std::size_t p = 0; p < period_; ++p) {
      const HearingSpectra::Vehicle& own = spectra_.vehicle(first_ + p);
      for (const auto& packet : own.packets) {
        const Eigen::VectorXd of = spectra_.drives(own, packet, window);
        drives.segment(at, of.size()) = of;
        at += of.size();
      }
      spectra_.advance(first_ + p, added[p], window);
    }
    return drives;
  }

  void add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const override {
    Eigen::Index at = 0;
    for (std::size_t p = 0; p < period_; ++p) {
      const HearingSpectra::Vehicle& own = spectra_.vehicle(first_ + p);
      for (const auto& packet : own.packets) {
        const Eigen::Index count = spectra_.dimensions(own, packet);
        if (count > 0) added[p] += spectra_.of_drives(own, packet, drives.segment(at, count));
        at += count;
      }
    }
  }

  std::unique_ptr<StringWalk> walk_behind(const std::vector<Eigen::ArrayXd>& added) const override {
    return std::make_unique<HearingWalk>(spectra_, first_, in_front(added));
  }

private:
  /// Adds all further rounds to of_one_ at these frequencies, by doubling. `power`: the product of a pattern there.
  void add_repetitions(Eigen::Index from, SpectralMatrix power) {
    constexpr double kNegligible = 1e-20;
    for (int doubling = 0; doubling < 60; ++doubling) {
      check_interruption();
      const Eigen::Index left = above(kNegligible, power);  // the lowest frequencies decay last
      if (left == 0) break;
      power = part(power, 0, left);
      const SpectralMatrix turned = adjoint(power);
      for (Window& window : of_one_) add_to(window, from, product(product(power, part(window, from, left)), turned));
      power = product(power, power);
    }
  }

  Window in_front(const std::vector<Eigen::ArrayXd>& added) const {
    Window window = spectra_.nothing();
    for (std::size_t p = 0; p < period_; ++p) {
      for (std::size_t i = 0; i < window.size(); ++i) {
        for (std::size_t j = 0; j < window.size(); ++j) window[i][j] += added[p] * of_one_[p][i][j];
      }
    }
    return window;
  }

  const HearingSpectra& spectra_;
  std::size_t period_, first_;
  std::vector<Window> of_one_;  ///< in front, if a place alone adds 1; by doubling
};

}  // namespace

std::unique_ptr<EndlessString> endless_hearing(const HearingSpectra& spectra, std::size_t period) {
  std::size_t first = spectra.reach() + 1;
  while ((first - 1) % period != 0) ++first;  // whole patterns later, so that it begins one
  return std::make_unique<EndlessHearing>(spectra, period, first);
}

}  // namespace platoon
