#include "stochastic_platoon/math/string/hearing_string.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>

#include "stochastic_platoon/math/links/link_filter.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/endless_hearing.hpp"
#include "stochastic_platoon/math/string/hearing_gain.hpp"
#include "stochastic_platoon/math/string/hearing_spectra.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

// Of steady_places(), with losses on average. A lost speed that counts as 0 acts through 1 / K at rest.
double lateness(const VehicleModel& own, const Input& input, double speed, double period) {
  const std::optional<LossModel> loss = input.link.loses() ? input.link.loss : std::nullopt;
  if (input.signal == InputSignal::position)
    return speed * (static_cast<double>(input.link.delay) + (loss ? LossFilter(*loss).lag() : 0.0));
  if (input.signal != InputSignal::speed || !loss || !loss->predictor.empty()) return 0.0;
  const ExactTransfer& controller = own.design->controller.exact();
  const Exact at_rest =
      controller.denominator.front() == 0 ? Exact(0) : controller.denominator.front() / controller.numerator.front();
  const double divided = own.design->divide_by_one_plus_headway ? 1.0 + own.headway : 1.0;
  return at_rest.convert_to<double>() * divided * input.gain * loss->probability * speed / period;
}

// Accuracy of a spectral radius near w = 0, where it is 1 - alpha w^2 without inputs from the leader.
constexpr double kDoubt = 1e-9;

// Where it is compared with 1 [rad/sample]: not so low that its distance from 1 is rounding.
double low_frequency(const HearingGain& gain) {
  return std::clamp(gain.slowest(), 1e-5, 1e-3);
}

// On panels that shorten towards the poles of the vehicles and of the noise, and towards w = 0, where the spectra
// narrow along the string.
std::vector<double> settled_on_panels(const PlatoonModel& model,
                                      const std::function<std::vector<double>(const HearingSpectra&)>& values,
                                      const Settling& settling) {
  constexpr int kMostRefined = 4;
  std::vector<std::complex<double>> singular;
  const std::size_t last = farthest_ahead(model) + type_order(model).size();
  for (std::size_t i = 1; i <= last; ++i) {
    const VehicleModel& own = vehicle(model, i);
    for (const std::complex<double>& w : frequencies_of(HearingLoop(own, i, model.sample_period).poles()))
      singular.push_back(w);
    for (const Input& input : own.inputs) {
      for (const std::complex<double>& w : LinkFilter(input.link, input.noise_variance).noise_frequencies())
        singular.push_back(w);
    }
  }
  std::vector<double> coarse;
  for (int refinement = 0; refinement <= kMostRefined; ++refinement) {
    std::vector<double> fine =
        values(HearingSpectra(model, SpectralNodes(half_circle_quadrature(singular, {0.0}, refinement))));
    if (refinement > 0 && settling.done(coarse, fine)) return fine;
    coarse.swap(fine);
  }
  throw NarrowSpectra();
}

}  // namespace

Settling to_all_digits() {
  constexpr double kSettled = 1e-9;
  return {[](const std::vector<double>& before, const std::vector<double>& now) {
    return largest_change(before, now) <= kSettled;
  }};
}

std::vector<double> settled_hearing(const PlatoonModel& model,
                                    const std::function<std::vector<double>(const HearingSpectra&)>& values,
                                    const Settling& settling) {
  constexpr std::size_t kFewest = 512;
  // With fewer than two nodes in each of its turns, a delay looks like a shorter one, with n / 2 nodes as with n.
  std::size_t fewest = kFewest;
  for (const auto needed = 4 * static_cast<std::size_t>(longest_delay(model)); fewest < needed;) fewest *= 2;
  std::vector<double> coarse;
  for (std::size_t n = fewest;; n *= 2) {
    std::vector<double> fine = values(HearingSpectra(model, n));
    if (!coarse.empty() && settling.done(coarse, fine)) return fine;
    if (n >= std::max(settling.most, 2 * fewest)) break;
    coarse.swap(fine);
  }
  if (loses(model)) throw NarrowSpectra();  // what losses with memory scatter is known at equally spaced nodes
  return settled_on_panels(model, values, settling);
}

HearingTheory::HearingTheory(const PlatoonModel& given)
    : StringTheory(given), period_(type_order(given).size()), growth_(0.0) {
  if (const std::optional<std::string> reason = no_theory(given))
    throw std::invalid_argument("no theory, as " + *reason);
  any_link(given, [this](const LinkModel& link) {
    if (link.loses()) growth_ = std::max(growth_, second_moment_radius(*link.loss));
    return false;  // all links
  });
}

double HearingTheory::spectral_radius() const {
  if (spectral_radius_) return *spectral_radius_;
  double largest = 0.0;
  for (std::size_t i = 1; i <= farthest_ahead(model()) + period_; ++i)
    largest = std::max(largest, HearingLoop(vehicle(model(), i), i, model().sample_period).spectral_radius());
  return *(spectral_radius_ = largest);
}

std::vector<double> HearingTheory::means(std::size_t followers) const {
  if (!mean_square_stable()) return std::vector<double>(followers, kNaN);
  constexpr double kRounding = 1e-14;  // relative to a vehicle's place
  const double speed = metres_per_step(model());
  std::map<const Input*, double> known;  // the inputs of a type serve all its vehicles
  const auto late = [&](const VehicleModel& own, const Input& input) {
    const auto inserted = known.emplace(&input, 0.0);
    if (inserted.second) inserted.first->second = lateness(own, input, speed, model().sample_period);
    return inserted.first->second;
  };
  const std::vector<double> places = steady_places(model(), followers, speed, late);
  std::vector<double> means;
  for (std::size_t i = 1; i <= followers; ++i) {
    const VehicleModel& own = vehicle(model(), i);
    const double mean = places[i - 1] - places[i] - speed * own.headway - own.standstill_distance;
    means.push_back(std::abs(mean) > kRounding * std::abs(places[i]) ? mean : 0.0);
  }
  return means;
}

const HearingGain& HearingTheory::gain() const {
  if (gain_ == nullptr) gain_ = std::make_unique<const HearingGain>(model());
  return *gain_;
}

std::vector<double> HearingTheory::gains(const std::vector<double>& frequencies) const {
  std::vector<double> gains;
  for (const double w : frequencies) gains.push_back(gain()(w));
  return gains;
}

JudgedGain HearingTheory::judged_gain() const {
  const HearingGain::Peak peak = gain().peak();
  if (peak.gain > 1.0 + kDoubt) return {Sign::kBelow, peak.gain - 1.0, peak.frequency};
  const double lowest = std::min(1e-7, 1e-3 * gain().slowest());  // the gain is g(0) + O(w^2)
  const double at_zero = (4.0 * gain()(0.5 * lowest) - gain()(lowest)) / 3.0, low = low_frequency(gain());
  const double excess = std::max(at_zero, std::min(peak.gain, 1.0)) - 1.0;
  JudgedGain judged{1.0 - gain()(low) > kDoubt * low ? Sign::kAbove : Sign::kZero,
                    std::abs(excess) < kDoubt ? 0.0 : excess, at_zero >= peak.gain - kDoubt ? 0.0 : peak.frequency};
  judged.falls_apart = gain().falls_apart();
  return judged;
}

StringEnd HearingTheory::end(bool with_variances) const {
  StringEnd end;
  if (with_variances) {
    try {
      settled_hearing(model(), [&](const HearingSpectra& spectra) {
        const auto string = endless_hearing(spectra, period_);
        end.loss_gain = string->loss_gain();
        end.variances = end.loss_gain >= 1.0 ? std::vector<double>(period_, 0.0) : string->variances(string->added());
        std::vector<double> settling = end.variances;
        settling.push_back(1.0 + end.loss_gain);  // a gain of 1e-15 has no digits that could settle
        return settling;
      });
      const auto is_finite = [](double value) { return std::isfinite(value); };
      if (std::all_of(end.variances.begin(), end.variances.end(), is_finite)) return end;
    } catch (const NarrowSpectra&) {
      // The side of 1 of the loss gain takes fewer frequencies.
    }
  }
  end = StringEnd();
  end.has_digits = false;
  end.loss_gain = loss_gain_beside_one();
  return end;
}

double HearingTheory::gain_margin() const {
  const double radius = std::max(spectral_radius(), growth_);
  if (!(radius < 1.0)) return 1.0 - radius;
  if (gain().falls_apart()) return -1.0;
  const double beyond = gain().peak().gain - 1.0 - kDoubt, low = low_frequency(gain());
  return beyond > 0.0 ? -beyond : (1.0 - gain()(low)) / low - kDoubt;
}

double HearingTheory::loss_gain_beside_one() const {
  if (!loses(model())) return 0.0;
  // A variance shows a narrow peak of the string's gain. The sign of the margin is known before its value.
  constexpr double kResolved = 1e-4, kCertain = 0.05;
  const auto is_certain = [](const std::vector<double>& before, const std::vector<double>& now) {
    return std::abs(now[0] - before[0]) <= kCertain * std::abs(1.0 - now[0]) &&
           std::abs(now[1] - before[1]) <= kResolved * now[1];
  };
  constexpr double kShare = 0.01;
  const auto gain = [this](const HearingSpectra& spectra) {
    const auto string = endless_hearing(spectra, period_);
    const std::vector<Eigen::ArrayXd> ones(period_, Eigen::ArrayXd::Ones(spectra.moved().size()));
    return std::vector<double>{string->loss_gain_beside_one(kShare), string->variances(ones).front()};
  };
  return settled_hearing(model(), gain, {is_certain}).front();
}

std::vector<double> HearingTheory::settled(std::size_t, const Values& values) const {
  return settled_hearing(model(), [&values](const HearingSpectra& spectra) {
    HearingWalk walk(spectra);
    return values(walk);
  });
}

std::vector<double> HearingTheory::settled_behind_endless(const Values& values) const {
  return settled_hearing(model(), [&](const HearingSpectra& spectra) {
    const auto string = endless_hearing(spectra, period_);
    return values(*string->walk_behind(string->added()));
  });
}

}  // namespace platoon
