#include "stochastic_platoon/math/string/hearing_spectra.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "stochastic_platoon/math/links/link_filter.hpp"
#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

// What a lost value lacks while the platoon moves steadily.
double steady_drive(const Input& input, const LossScatter& losses, double speed, double period) {
  if (input.signal == InputSignal::position) return speed * losses.slope();
  return input.signal == InputSignal::speed && input.link.loss->predictor.empty() ? speed / period : 0.0;
}

}  // namespace

HearingSpectra::HearingSpectra(const PlatoonModel& model, SpectralNodes nodes)
    : model_(model),
      nodes_(std::move(nodes)),
      moved_(nodes_.count()),
      reach_(farthest_ahead(model)),
      speed_(metres_per_step(model)) {
  for (Eigen::Index k = 0; k < moved_.size(); ++k) {
    const auto from_one = nodes_.points[static_cast<std::size_t>(k)].from_one();
    moved_(k) = std::complex<double>(from_one * std::conj(1.0L + from_one));
  }
}

HearingSpectra::Window HearingSpectra::nothing() const {
  return {reach_, std::vector<Eigen::ArrayXcd>(reach_, Eigen::ArrayXcd::Zero(nodes_.count()))};
}

const HearingSpectra::Vehicle& HearingSpectra::vehicle(std::size_t follower) const {
  const std::size_t place = (follower - 1) % type_order(model_).size();
  const auto inserted = vehicles_.emplace(std::make_pair(place, std::min(follower, reach_ + 1)), Vehicle());
  Vehicle& of = inserted.first->second;
  if (!inserted.second) return of;
  const VehicleModel& own = platoon::vehicle(model_, follower);
  const double period = model_.sample_period;
  const Eigen::Index count = nodes_.count();
  const HearingLoop loop(own, follower, period);
  std::vector<LinkFilter> links;
  std::vector<std::optional<HearingLoop>> sources;  // of control inputs
  for (std::size_t j = 0; j < own.inputs.size(); ++j) {
    const Input& input = own.inputs[j];
    const std::size_t source = source_of(input, follower);
    LinkModel lossless = input.link;
    lossless.loss.reset();
    links.emplace_back(lossless, input.noise_variance);
    sources.emplace_back();
    if (input.signal == InputSignal::input)
      sources.back().emplace(platoon::vehicle(model_, source), std::max<std::size_t>(source, 1), period);
    of.inputs.push_back({source == 0 ? 0 : follower - source,
                         Eigen::ArrayXcd(count),
                         Eigen::ArrayXcd(count),
                         {},
                         Eigen::ArrayXd(count),
                         0.0});
    if (!input.link.loss || input.link.loss->probability == 0.0) continue;
    const std::size_t first = own.losses_of(j);
    if (first == j) of.packets.push_back({{}, scatter(*input.link.loss), Eigen::ArrayXcd(count)});
    const auto packet = std::find_if(of.packets.begin(), of.packets.end(), [&](const Vehicle::Packet& shared) {
      return shared.inputs.empty() || shared.inputs.front() == first;
    });
    packet->inputs.push_back(j);
    of.inputs.back().steady = steady_drive(input, *packet->losses, speed_, period);
  }
  of.policy = 1.0 + own.headway * moved_;
  for (Eigen::Index k = 0; k < count; ++k) {
    check_interruption();
    const auto node = static_cast<std::size_t>(k);
    const CirclePoint& point = nodes_.points[node];
    const HearingLoop::Value value = loop.at(point);
    for (std::size_t j = 0; j < own.inputs.size(); ++j) {
      const HearingLoop::Complex of_source = sources[j] ? sources[j]->at(point).sent : 0.0L;
      of.inputs[j].own(k) = std::complex<double>(value.of(own.inputs[j]));
      of.inputs[j].sent(k) = std::complex<double>(sent_value(own.inputs[j], point, of_source, period));
      of.inputs[j].noise(k) = links[j].noise(point);
    }
    for (Vehicle::Packet& packet : of.packets)
      packet.passed(k) = std::complex<double>(packet.losses->effects()[node].passed);
  }
  for (Vehicle::Heard& input : of.inputs) input.transfer = input.own * input.sent;
  for (const Vehicle::Packet& packet : of.packets) {
    for (const std::size_t j : packet.inputs) of.inputs[j].transfer *= packet.passed;
  }
  return of;
}

HearingSpectra::Filters HearingSpectra::filters(const Signal& signal, std::size_t follower) const {
  const auto of_term = [this](const Signal::Term& term) {
    Eigen::ArrayXcd values = Eigen::ArrayXcd::Constant(nodes_.count(), term.factor);
    for (int n = 0; n < term.order; ++n) values *= moved_;
    return values;
  };
  Filters filters{Eigen::ArrayXcd::Zero(nodes_.count()), of_term(signal.apart)};
  if (signal.is_input) {
    const HearingLoop loop(platoon::vehicle(model_, follower), follower, model_.sample_period);
    for (Eigen::Index k = 0; k < filters.own.size(); ++k)
      filters.own(k) = std::complex<double>(loop.at(nodes_.points[static_cast<std::size_t>(k)]).sent);
  } else if (signal.own.order > 0) {
    filters.own = of_term(signal.own);
  }
  filters.own -= filters.predecessor;
  return filters;
}

// Links with the same losses share their scatter.
std::shared_ptr<const LossScatter> HearingSpectra::scatter(const LossModel& loss) const {
  for (const auto& known : scatters_) {
    if (known.first == loss) return known.second;
  }
  scatters_.emplace_back(loss, std::make_shared<LossScatter>(LossFilter(loss), nodes_));
  return scatters_.back().second;
}

std::vector<Eigen::ArrayXcd> HearingSpectra::transfers(std::size_t follower) const {
  std::vector<Eigen::ArrayXcd> sums(reach_, Eigen::ArrayXcd::Zero(nodes_.count()));
  for (const Vehicle::Heard& input : vehicle(follower).inputs) {
    if (input.distance > 0) sums[input.distance - 1] += input.transfer;
  }
  return sums;
}

std::vector<Eigen::ArrayXd> HearingSpectra::added(std::size_t follower, const Window& ahead) const {
  const Vehicle& own = vehicle(follower);
  std::vector<Eigen::ArrayXd> by_input;
  for (const Vehicle::Heard& input : own.inputs) by_input.emplace_back(input.own.abs2() * input.noise);
  for (const Vehicle::Packet& packet : own.packets) {
    for (const std::size_t j : packet.inputs) by_input[j] *= packet.passed.abs2();
    by_input[packet.inputs.front()] += scattered(own, packet, ahead, true);
  }
  return by_input;
}

// With the noises and the platoon's own motion, or without them.
Eigen::ArrayXd HearingSpectra::scattered(const Vehicle& own, const Vehicle::Packet& packet, const Window& ahead,
                                         bool with_noise) const {
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(nodes_.count());
  for (const std::size_t j : packet.inputs) {
    const Vehicle::Heard& one = own.inputs[j];
    for (const std::size_t l : packet.inputs) {
      if (l < j) continue;  // the conjugate of another
      const Vehicle::Heard& other = own.inputs[l];
      Eigen::ArrayXcd sent = Eigen::ArrayXcd::Zero(sum.size());
      if (one.distance > 0) {
        const std::size_t at = one.distance - 1;
        sent = one.sent * other.sent.conjugate() * ahead[at][at];
      }
      if (with_noise && j == l) sent += one.noise.cast<std::complex<double>>();
      Eigen::ArrayXcd scattered = packet.losses->of_cross_spectrum(sent);
      if (with_noise)
        scattered += one.steady * other.steady * packet.losses->of_constant_drive().cast<std::complex<double>>();
      sum += (l > j ? 2.0 : 1.0) * (one.own * other.own.conjugate() * scattered).real();
    }
  }
  return sum;
}

Eigen::Index HearingSpectra::dimensions(const Vehicle& own, const Vehicle::Packet& packet) const {
  if (own.inputs[packet.inputs.front()].distance == 0) return 0;
  return packet.inputs.size() == 1 ? packet.losses->dimensions() : nodes_.count();
}

Eigen::VectorXd HearingSpectra::drives(const Vehicle& own, const Vehicle::Packet& packet, const Window& ahead) const {
  const Vehicle::Heard& first = own.inputs[packet.inputs.front()];
  if (first.distance == 0) return Eigen::VectorXd(0);
  if (packet.inputs.size() > 1) return scattered(own, packet, ahead, false).matrix();
  return packet.losses->drives((first.sent.abs2() * ahead[first.distance - 1][first.distance - 1].real()).matrix());
}

Eigen::ArrayXd HearingSpectra::of_drives(const Vehicle& own, const Vehicle::Packet& packet,
                                         const Eigen::VectorXd& drives) const {
  if (packet.inputs.size() > 1) return drives.array();
  return own.inputs[packet.inputs.front()].own.abs2() * (*packet.losses)(drives).array();
}

double HearingSpectra::variance(const Pair& pair, const Filters& of) const {
  const Eigen::ArrayXcd both = of.own * of.predecessor.conjugate() * pair.cross;
  const Eigen::ArrayXd spectrum =
      of.own.abs2() * pair.own + (of.predecessor.abs2() * pair.predecessor + 2.0 * both.real());
  return nodes_.equally_spaced ? spectrum.mean() : (nodes_.weight * spectrum).sum();
}

HearingSpectra::Pair HearingSpectra::advance(std::size_t follower, const Eigen::ArrayXd& added, Window& window) const {
  check_interruption();
  const std::vector<Eigen::ArrayXcd> from = transfers(follower);
  std::vector<Eigen::ArrayXcd> cross;  // with the vehicles of the window
  Eigen::ArrayXcd own = added.cast<std::complex<double>>();
  for (std::size_t b = 0; b < reach_; ++b) {
    cross.emplace_back(Eigen::ArrayXcd::Zero(own.size()));
    for (std::size_t a = 0; a < reach_; ++a) cross[b] += from[a] * window[a][b];
    own += cross[b] * from[b].conjugate();
  }
  const Pair pair{own.real(), window[0][0].real(), cross[0]};
  for (std::size_t a = reach_; a-- > 1;) {
    for (std::size_t b = reach_; b-- > 1;) window[a][b] = window[a - 1][b - 1];
  }
  window[0][0] =
      own.real().cast<std::complex<double>>();  // the rounding of an imaginary part would grow along the string
  for (std::size_t b = 1; b < reach_; ++b) {
    window[0][b] = cross[b - 1];
    window[b][0] = cross[b - 1].conjugate();
  }
  return pair;
}

std::array<double, 2> HearingWalk::moments(const Signal& signal) const {
  const HearingSpectra::Filters filters = spectra_->filters(signal, next_ - 1);
  const Eigen::ArrayXd turned = spectra_->moved().abs2();
  const HearingSpectra::Pair changes{turned * last_.own, turned * last_.predecessor, turned * last_.cross};
  return {spectra_->variance(last_, filters), spectra_->variance(changes, filters)};
}

double HearingWalk::error_variance() const {
  const Eigen::ArrayXcd& policy = spectra_->vehicle(next_ - 1).policy;
  return spectra_->variance(last_, {-policy, Eigen::ArrayXcd::Ones(policy.size())});
}

}  // namespace platoon
