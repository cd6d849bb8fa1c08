#include "stochastic_platoon/math/links/string_responses.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/links/leader_motion.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

using Sequence = VehicleResponse::Sequence;

// What an input carries of the motion of its source.
Sequence carried(const Input& input, const Motion& source, double period) {
  if (is_difference(input.signal)) return signal_values(difference(input.signal, period), {}, source);
  return input.signal == InputSignal::position ? source.position : source.input;
}

void add_multiple(long double factor, const Sequence& from, Sequence& to) {
  for (std::size_t a = 0; a < from.size(); ++a) to[a] += factor * from[a];
}

}  // namespace

StringResponses::StringResponses(const PlatoonModel& model, std::size_t followers, std::size_t steps, Pass pass)
    : model_(model),
      followers_(followers),
      count_(steps + 1),
      reach_(farthest_ahead(model)),
      different_{reach_ - 1, type_order(model).size()} {
  if (has_limits(model)) throw std::invalid_argument("no theory, as vehicles have limits");
  for (std::size_t i = 1; i <= std::min(followers, different_.count()); ++i) {
    const VehicleModel& own = vehicle(model, i);
    vehicles_.push_back({VehicleResponse(own, i, model.sample_period), {}});
    for (const Input& input : own.inputs) {
      const LinkModel& link = input.link;
      vehicles_.back().links.push_back({static_cast<std::size_t>(input.delay()), link.loss.value_or(LossModel()),
                                        pass == Pass::values && !link.loses()});
      if (!vehicles_.back().links.back().loss.is_independent())
        throw std::invalid_argument("mean_burst: given: must be absent for this theory");
    }
  }
}

double StringResponses::loss_factor(std::size_t follower, std::size_t input) const {
  const double q = vehicles_[different_.of(follower) - 1].links[input].loss.probability;
  return q * (1.0 - q);
}

std::vector<StringResponses::Source> StringResponses::sources(std::size_t follower) const {
  const VehicleModel& own = vehicle(model_, follower);
  std::vector<Source> found;
  Sequence impulse(count_, 0.0L);
  impulse[1] = 1.0L;
  for (std::size_t n = 0; n < own.inputs.size(); ++n) {
    const LinkModel& link = own.inputs[n].link;
    const double noise = own.inputs[n].noise_variance, dither = link.quantisation_step * link.quantisation_step / 12.0;
    const bool is_white = link.has_white_noise();
    if (noise > 0.0)
      found.push_back({follower, n, noise, is_white ? impulse : filtered_impulse(link.noise_filter, count_ - 1)});
    if (dither > 0.0) found.push_back({follower, n, dither, impulse});
  }
  if (own.initial_position.variance > 0.0) found.push_back({follower, std::nullopt, own.initial_position.variance, {}});
  return found;
}

void StringResponses::visit(const Source& source, const Visitor& visitor) const {
  visit(&source, nullptr, visitor);
}

void StringResponses::visit_means(const Visitor& visitor) const {
  const Motion leader = leader_motion(model_, count_ - 1);
  visit(nullptr, &leader, visitor);
}

// Without source the leader and the means of initial positions move the vehicles.
void StringResponses::visit(const Source* source, const Motion* leader, const Visitor& visitor) const {
  const Sequence still(count_, 0.0L);
  std::vector<Motion> ahead;  // the vehicles that move and that others behind hear, the nearest last
  for (std::size_t i = source != nullptr ? source->follower : 1; i <= followers_; ++i) {
    check_interruption();
    Response own = response(i, ahead, leader, ahead.empty() ? source : nullptr);
    const double placed = source == nullptr ? vehicle(model_, i).initial_position.mean : 0.0;
    if (placed != 0.0) {
      const Motion free = vehicles_[different_.of(i) - 1].vehicle.free_motion(count_);
      add_multiple(placed, free.position, own.own.position);
      add_multiple(placed, free.input, own.own.input);
    }
    const Sequence& behind = leader != nullptr ? leader->position : still;
    visitor(i, ahead.empty() ? behind : ahead.back().position, own);
    ahead.push_back(std::move(own.own));
    if (ahead.size() > reach_) ahead.erase(ahead.begin());
  }
}

StringResponses::Response StringResponses::response(std::size_t follower, const std::vector<Motion>& ahead,
                                                    const Motion* leader, const Source* source) const {
  const Follower& responding = vehicles_[different_.of(follower) - 1];
  const VehicleModel& own = vehicle(model_, follower);
  const std::vector<Input>& inputs = own.inputs;
  Response found{{}, std::vector<Sequence>(inputs.size())};
  if (source != nullptr && !source->input) {
    found.own = responding.vehicle.free_motion(count_);
    return found;
  }
  const bool plain = own.hears_predecessor_only();  // its response has the gain of its radio
  Motion used{Sequence(count_, 0.0L), Sequence(count_, 0.0L)};
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const Input& input = inputs[n];
    Sequence sent;
    if (source != nullptr) {
      if (*source->input != n) continue;
      sent = source->impulse;
    } else {
      const std::size_t from = source_of(input, follower), distance = follower - from;
      if (from == 0 ? leader == nullptr : distance > ahead.size()) continue;  // the source stands still
      sent = carried(input, from == 0 ? *leader : ahead[ahead.size() - distance], model_.sample_period);
    }
    const MeanLink& link = responding.links[n];
    Sequence& sum = input.signal == InputSignal::position ? used.position : used.input;
    add_multiple(plain ? 1.0 : input.gain,
                 sent.empty() ? link.after_loss(count_, found.innovation[n]) : link.pass(sent, found.innovation[n]),
                 sum);
  }
  found.own = responding.vehicle(used);
  return found;
}

// c_1 r(k-1) + c_2 r(k-2) + ...
long double StringResponses::MeanLink::prediction(const Sequence& received) const {
  long double sum = 0.0L;
  for (std::size_t j = 0; j < loss.predictor.size(); ++j)
    sum += loss.predictor[j] * (received.size() > j ? received[received.size() - 1 - j] : received.front());
  return sum;
}

Sequence StringResponses::MeanLink::pass(const Sequence& sent, Sequence& innovation) const {
  check_interruption();
  const long double arrival = 1.0L - static_cast<long double>(loss.probability);
  Sequence received{sent.front()};
  received.reserve(sent.size());
  for (std::size_t a = 1; a < sent.size(); ++a) {
    const long double arriving = sent[a > delay ? a - delay : 0];
    if (passes_values) {
      received.push_back(arriving);
      continue;
    }
    const long double predicted = prediction(received);
    innovation.push_back(arriving - predicted);
    received.push_back(predicted + arrival * innovation.back());
  }
  return received;
}

// The response of the received values to a w of 1 at step 0.
Sequence StringResponses::MeanLink::after_loss(std::size_t count, Sequence& innovation) const {
  Sequence received{0.0L};
  for (std::size_t a = 1; a < count; ++a) {
    const long double predicted = prediction(received);
    innovation.push_back(-predicted);
    received.push_back(static_cast<long double>(loss.probability) * predicted + (a == 1 ? 1.0L : 0.0L));
  }
  return received;
}

Sequence filtered_impulse(const TransferFunction& filter, std::size_t steps) {
  const Polynomial &b = filter.numerator(), &a = filter.denominator();
  const Eigen::Index lead = a.size() - b.size();
  Sequence w(steps + 1, 0.0L);
  for (std::size_t k = 0; k < steps; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    long double value = at >= lead && at - lead < b.size() ? b(at - lead) : 0.0;
    for (Eigen::Index j = 1; j < a.size() && j <= at; ++j) value -= a(j) * w[k + 1 - static_cast<std::size_t>(j)];
    w[k + 1] = value;
  }
  return w;
}

Sequence signal_values(const Signal& signal, const Sequence& predecessor, const Motion& motion) {
  if (signal.is_input) return motion.input;
  const Sequence& own = motion.position;
  Sequence sum(own.size(), 0.0L);
  check_interruption();
  const auto add = [&sum](const Signal::Term& term, Sequence values) {
    for (int n = 0; n < term.order; ++n) {
      for (std::size_t a = values.size(); --a > 0;) values[a] -= values[a - 1];
      values[0] = 0.0L;
    }
    for (std::size_t a = 0; a < sum.size(); ++a) sum[a] += static_cast<long double>(term.factor) * values[a];
  };
  if (signal.own.order > 0) add(signal.own, own);
  if (signal.is_relative()) {
    Sequence apart = own;
    for (std::size_t a = 0; a < apart.size(); ++a) apart[a] = predecessor[a] - own[a];
    add(signal.apart, std::move(apart));
  }
  return sum;
}

void add_means(const Signal& signal, double standstill_distance, const Sequence& predecessor, const Motion& motion,
               std::vector<double>& means) {
  const Sequence values = signal_values(signal, predecessor, motion);
  for (std::size_t a = 1; a < values.size(); ++a)
    means.push_back(static_cast<double>(values[a] + static_cast<long double>(signal.at_rest(standstill_distance))));
}

}  // namespace platoon
