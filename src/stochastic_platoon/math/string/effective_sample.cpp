#include "stochastic_platoon/math/string/effective_sample.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

constexpr double kEndOfCorrelation = 1e-15;  // relative size at which an autocorrelation ends
constexpr double kResolved = 1e-13;          // the same at the end of a transform, whose rounding grows with its peaks
constexpr std::size_t kFirstLength = 1024, kMostLength = std::size_t{1} << 20;
constexpr std::size_t kMostValues = std::size_t{1} << 28;  // followers times length
constexpr std::size_t kMostKept = std::size_t{1} << 22;    // 32 MB

/// The spectra of all errors at equally spaced frequencies 0 .. pi.
class Spectra {
public:
  Spectra(const LinkedPattern& pattern, std::size_t length) : pattern_(pattern) {
    const auto count = static_cast<Eigen::Index>(length / 2 + 1);
    for (const LinkedVehicle& vehicle : pattern.types) {
      types_.emplace_back();
      Type& type = types_.back();
      for (auto* values : {&type.gain, &type.complement, &type.added, &type.of_added}) values->resize(count);
      for (Eigen::Index f = 0; f < count; ++f) {
        check_interruption();
        const LinkedVehicleValue value =
            vehicle.at(2.0 * boost::math::double_constants::pi * static_cast<double>(f) / static_cast<double>(length));
        type.gain(f) = value.gain;
        type.complement(f) = value.complement;
        type.added(f) = 0.0;
        for (const InputValue& input : value.input) type.added(f) += input.passed * input.noise;
        type.of_added(f) = value.spacing_gain * type.added(f);
      }
    }
  }

  /// Calls visit(i, Phi_zeta of follower i + 1, its value at 0) for i = 0, 1, ..., up to the first lossy link.
  template <class Visit>
  void pass(std::size_t followers, const Visit& visit) const {
    Eigen::ArrayXd position = Eigen::ArrayXd::Zero(types_.front().gain.size()), error;
    for (std::size_t i = 0; i < followers; ++i) {
      check_interruption();
      if (pattern_[i].has_losses()) return;
      const Type& type = types_[pattern_.type(i)];
      error = type.complement * position + type.of_added;
      position = type.gain * position + type.added;
      // T(1) = H(1) = 1: the predecessor's part vanishes.
      visit(i, error, type.added(0));
    }
  }

private:
  struct Type {
    Eigen::ArrayXd gain, complement, added, of_added;
  };

  const LinkedPattern& pattern_;
  std::vector<Type> types_;
};

/// Autocovariances at 0 .. length / 2 from a spectrum.
class Transform {
public:
  explicit Transform(std::size_t length) : length_(length) { fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum); }

  std::vector<double> operator()(const Eigen::ArrayXd& spectrum) {
    half_.assign(spectrum.data(), spectrum.data() + spectrum.size());
    fft_.inv(all_, half_, static_cast<Eigen::Index>(length_));
    return {all_.begin(), all_.begin() + static_cast<std::ptrdiff_t>(length_ / 2)};
  }

private:
  std::size_t length_;
  Eigen::FFT<double> fft_;
  std::vector<std::complex<double>> half_;
  std::vector<double> all_;
};

bool is_resolved(const std::vector<double>& covariance) {
  const auto beyond = [&](double value) { return std::abs(value) > kResolved * covariance.front(); };
  return std::none_of(covariance.begin() + static_cast<std::ptrdiff_t>(covariance.size() / 2), covariance.end(),
                      beyond);
}

ErrorCorrelation correlation_of(std::vector<double> covariance, double at_zero, std::size_t* kept) {
  const double variance = covariance.front();
  if (variance == 0.0) return {{1.0}, 1.0, true};
  if (!std::isfinite(variance)) return {};
  for (double& value : covariance) value /= variance;
  while (std::abs(covariance.back()) <= kEndOfCorrelation) covariance.pop_back();
  const bool keep = covariance.size() <= *kept;
  if (keep) *kept -= covariance.size();
  return {std::move(covariance), at_zero / variance, keep};
}

}  // namespace

ErrorCorrelation::ErrorCorrelation()
    : sum_(kNaN), sum_of_lags_(kNaN), squares_(kNaN), square_of_lags_(kNaN), boundary_(kNaN) {}

ErrorCorrelation::ErrorCorrelation(std::vector<double> autocorrelation, double sum, bool keep)
    : length_(autocorrelation.size()),
      sum_(sum),
      sum_of_lags_(0.0),
      squares_(1.0),
      square_of_lags_(0.0),
      boundary_(0.0) {
  double tail = 0.0;  // sum of R beyond t
  for (std::size_t t = length_; t-- > 0;) {
    boundary_ += 2.0 * tail * (2.0 * sum_ - tail);
    const double r = autocorrelation[t];
    tail += r;
    if (t == 0) break;
    sum_of_lags_ += 2.0 * static_cast<double>(t) * r;
    squares_ += 2.0 * r * r;
    square_of_lags_ += 2.0 * static_cast<double>(t) * r * r;
  }
  if (keep) kept_ = std::move(autocorrelation);
}

IndependentShare ErrorCorrelation::of(std::uint64_t steps, std::uint64_t stretches) const {
  const std::uint64_t one = steps / std::max<std::uint64_t>(stretches, 1);  // steps per stretch
  if (one < 2 || length_ == 0 || (one < 2 * length_ && kept_.empty())) return {kNaN, kNaN, kNaN};
  const auto n = static_cast<double>(steps), m = static_cast<double>(stretches);
  double of_ones = n * sum_ - m * sum_of_lags_, trace = n * squares_ - m * square_of_lags_,
         of_square = n * sum_ * sum_ - m * boundary_;
  if (one < 2 * length_) {
    const auto of_one = static_cast<double>(one);
    of_ones = trace = of_one;
    of_square = 0.0;
    const auto r = [&](std::size_t t) { return t < length_ ? kept_[t] : 0.0; };
    double row = 0.0;  // row t of S1
    for (std::size_t t = 0; t < one; ++t) row += r(t);
    for (std::size_t t = 0; t < one; ++t) {
      of_square += row * row;
      row += r(t + 1) - r(one - 1 - t);
      if (t == 0) continue;
      of_ones += 2.0 * (of_one - static_cast<double>(t)) * r(t);
      trace += 2.0 * (of_one - static_cast<double>(t)) * r(t) * r(t);
    }
    for (double* sum : {&of_ones, &trace, &of_square}) *sum *= n / of_one;
  }
  const double spread = trace - 2.0 * of_square / n + (of_ones / n) * (of_ones / n);
  return {n / of_ones, (n - 1.0) / spread, (n - of_ones / n) / (n - 1.0)};
}

std::vector<ErrorCorrelation> error_correlations(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  std::vector<ErrorCorrelation> correlations(followers);
  const LinkedPattern pattern(model);
  if (pattern.spectral_radius() >= 1.0) return correlations;
  for (std::size_t length = kFirstLength; length <= kMostLength && length * followers <= kMostValues; length *= 2) {
    const Spectra spectra(pattern, length);
    Transform transform(length);
    // The correlation is longest at the end of the string.
    bool resolved = true;
    spectra.pass(followers, [&](std::size_t i, const Eigen::ArrayXd& error, double) {
      if (resolved && i + pattern.size() >= followers) resolved = is_resolved(transform(error));
    });
    if (!resolved) continue;
    std::size_t kept = kMostKept;
    spectra.pass(followers, [&](std::size_t i, const Eigen::ArrayXd& error, double at_zero) {
      std::vector<double> covariance = transform(error);
      if (is_resolved(covariance)) correlations[i] = correlation_of(std::move(covariance), at_zero, &kept);
    });
    break;
  }
  return correlations;
}

}  // namespace platoon
