#include "stochastic_platoon/math/rare/rare_losses.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

// The index that belongs to a uniform value, by weights.
std::uint8_t chosen(const Eigen::VectorXd& weights, double uniform) {
  Eigen::Index last = 0;
  double rest = uniform * weights.sum();
  for (Eigen::Index i = 0; i < weights.size() && rest >= 0.0; ++i) {
    rest -= weights(i);
    if (weights(i) > 0.0) last = i;
  }
  return static_cast<std::uint8_t>(last);
}

}  // namespace

// pi_b Pi_bc: the probabilities to be in b at a step and in c at the next one.
Eigen::VectorXd RareLosses::Chain::before(Eigen::Index mode) const {
  return stationary.cwiseProduct(transition.col(mode));
}

// The same for b != c: c begins.
Eigen::VectorXd RareLosses::Chain::before_begin(Eigen::Index mode) const {
  Eigen::VectorXd result = before(mode);
  result(mode) = 0.0;
  return result;
}

RareLosses::Chain::Chain(const LossModel& loss, std::int64_t steps)
    : is_drawn(loss.trace == nullptr && !loss.by_distance) {
  const LossChain chain(loss);
  chances = std::make_shared<ModeChances>(chain);
  stationary.resize(chain.modes());
  transition.resize(chain.modes(), chain.modes());
  for (Eigen::Index mode = 0; mode < chain.modes(); ++mode) {
    const auto to = static_cast<std::uint8_t>(mode);
    stationary(mode) = chances->probability(chances->start(), to);
    for (Eigen::Index from = 0; from < chain.modes(); ++from)
      transition(from, mode) = chances->probability(static_cast<std::size_t>(from), to);
  }
  begins = stationary;
  for (Eigen::Index mode = 0; mode < chain.modes(); ++mode)
    begins(mode) += static_cast<double>(steps - 1) * before_begin(mode).sum();
}

double GivenModes::draw(std::int64_t step, double uniform) const {
  if (step < 0 || step >= static_cast<std::int64_t>(modes.size())) return uniform;
  const auto k = static_cast<std::size_t>(step);
  return chances->leading(k == 0 ? chances->start() : modes[k - 1], modes[k], uniform);
}

RareLosses::RareLosses(const PlatoonModel& model, std::size_t followers, std::int64_t steps) : steps_(steps) {
  std::map<const LossModel*, std::shared_ptr<const Chain>> known;  // vehicles of one type share it
  for (std::size_t i = 1; i <= followers; ++i) {
    const std::vector<Input>& inputs = vehicle(model, i).inputs;
    for (std::size_t n = 0; n < inputs.size(); ++n) {
      if (!inputs[n].link.loses() || first_of_packet(inputs, n) != n) continue;
      const LossModel& loss = *inputs[n].link.loss;
      std::shared_ptr<const Chain>& of = known[&loss];
      if (of == nullptr) of = std::make_shared<Chain>(loss, steps);
      places_.push_back({loss_stream(model, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(n)), of});
    }
  }
  for (std::size_t place = 0; place < places_.size(); ++place) {
    const Chain& of = *places_[place].of;
    for (Eigen::Index mode = 0; of.is_drawn && mode < of.begins.size(); ++mode) {
      const double share = of.begins(mode) * static_cast<double>(places_.size());
      if (!(share > 0.0 && share < kMost)) continue;
      rare_.emplace_back(place, mode);
      expected_ += of.begins(mode);
    }
  }
}

std::shared_ptr<const GivenModes> RareLosses::draw(const std::function<double()>& uniform) const {
  const double number = uniform() * static_cast<double>(rare_.size());
  const auto [place, mode] = rare_[std::min(static_cast<std::size_t>(number), rare_.size() - 1)];
  const Chain& of = *places_[place].of;
  const Eigen::VectorXd beginning = of.before_begin(mode);
  const double begun = uniform() * of.begins(mode) - of.stationary(mode);
  const std::int64_t step =
      begun < 0.0 ? 0 : std::min(1 + static_cast<std::int64_t>(begun / beginning.sum()), steps_ - 1);
  std::vector<std::uint8_t> modes(static_cast<std::size_t>(step) + 1, static_cast<std::uint8_t>(mode));
  for (auto k = static_cast<std::size_t>(step); k > 0; --k)
    modes[k - 1] = chosen(k + 1 == modes.size() ? beginning : of.before(modes[k]), uniform());
  return std::make_shared<GivenModes>(GivenModes{places_[place].stream, of.chances, std::move(modes)});
}

void RareLosses::weights(const WhiteNoise& noise, std::uint64_t first, std::size_t count, double* weights,
                         std::int64_t* begins) const {
  std::fill_n(weights, count, 0.0);
  std::fill_n(begins, count, kNever);
  std::vector<double> uniforms(count);
  std::vector<std::uint8_t> modes(count);
  for (auto next = rare_.begin(); next != rare_.end();) {
    const Place& place = places_[next->first];
    std::vector<double> shares(static_cast<std::size_t>(place.of->begins.size()), 0.0);
    for (const std::size_t of = next->first; next != rare_.end() && next->first == of; ++next)
      shares[static_cast<std::size_t>(next->second)] = 1.0 / place.of->begins(next->second);
    const ModeChances& chances = *place.of->chances;
    for (std::int64_t step = 0; step < steps_; ++step) {
      noise.fill_uniform({place.stream, step, Purpose::loss}, first, count, uniforms.data());
      for (std::size_t s = 0; s < count; ++s) {
        const std::uint8_t mode = step > 0 ? chances.after(modes[s], uniforms[s]) : chances.first(uniforms[s]);
        if (step == 0 || mode != modes[s]) weights[s] += shares[mode];
        if (shares[mode] > 0.0) begins[s] = std::min(begins[s], step);
        modes[s] = mode;
      }
    }
  }
  for (std::size_t s = 0; s < count; ++s)
    weights[s] = weights[s] > 0.0 ? static_cast<double>(rare_.size()) / weights[s] : kInfinity;
}

RareLosses::Unseen RareLosses::unseen(std::size_t paths, std::uint64_t repetitions) const {
  const auto n = static_cast<double>(paths);
  double alone = 0.0, beside = 0.0, least = kInfinity;
  for (const Place& place : places_) {
    for (Eigen::Index mode = 0; mode < place.of->begins.size(); ++mode) {
      const double begins = place.of->begins(mode);
      if (!(begins > 0.0 && begins * n < 1.0)) continue;
      (place.of->is_drawn ? beside : alone) += begins;
      least = std::min(least, begins);
    }
  }
  double two = 0.5 * expected_ * expected_, most = 0.0, next = kInfinity;
  std::vector<double> of_place(places_.size(), 0.0);
  for (const auto& [place, mode] : rare_) {
    const Chain& of = *places_[place].of;
    const double remains = steps_ > 1 ? of.transition(mode, mode) : 0.0;
    if (remains * n < 1.0) two += of.begins(mode) * remains;
    of_place[place] += of.begins(mode);
    most = std::max(most, of.begins(mode));
    next = std::min(next, of.before_begin(mode).sum());
  }
  // No two modes of a link begin at one step.
  for (const double begins : of_place) two -= 0.5 * begins * begins / static_cast<double>(steps_);
  two = std::min(two, 3.0 * most * static_cast<double>(rare_.size()) / (n * static_cast<double>(repetitions)));
  const double unlikely = beside * (expected_ - 0.5 * beside);
  if (two > unlikely) least = std::min(least, next);
  return {std::min(1.0, alone + std::max(unlikely, two)), 1.0 / least};
}

}  // namespace platoon
