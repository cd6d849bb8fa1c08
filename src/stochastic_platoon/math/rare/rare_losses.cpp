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

// pi_b Pi_bc: the probabilities to be in b at a step and in c at the next one.
Eigen::VectorXd before(const LossChain& chain, Eigen::Index mode) {
  return chain.stationary().cwiseProduct(chain.transition().col(mode));
}

// The same for b != c: c begins.
Eigen::VectorXd before_begin(const LossChain& chain, Eigen::Index mode) {
  Eigen::VectorXd result = before(chain, mode);
  result(mode) = 0.0;
  return result;
}

}  // namespace

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
      if (of == nullptr) {
        const LossChain chain(loss);
        Eigen::VectorXd begins = chain.stationary();
        for (Eigen::Index mode = 0; mode < chain.modes(); ++mode)
          begins(mode) += static_cast<double>(steps - 1) * before_begin(chain, mode).sum();
        const bool is_drawn = loss.trace == nullptr && !loss.by_distance;
        of = std::make_shared<Chain>(Chain{chain, std::make_shared<ModeChances>(chain), begins, is_drawn});
      }
      places_.push_back({loss_stream(model, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(n)), of});
    }
  }
  for (std::size_t place = 0; place < places_.size(); ++place) {
    const Chain& of = *places_[place].of;
    for (Eigen::Index mode = 0; of.is_drawn && mode < of.chain.modes(); ++mode) {
      if (!(of.begins(mode) * static_cast<double>(places_.size()) < kMost)) continue;
      rare_.emplace_back(place, mode);
      expected_ += of.begins(mode);
    }
  }
}

std::shared_ptr<const GivenModes> RareLosses::draw(const std::function<double()>& uniform) const {
  const double number = uniform() * static_cast<double>(rare_.size());
  const auto [place, mode] = rare_[std::min(static_cast<std::size_t>(number), rare_.size() - 1)];
  const Chain& of = *places_[place].of;
  const Eigen::VectorXd beginning = before_begin(of.chain, mode);
  const double begun = uniform() * of.begins(mode) - of.chain.stationary()(mode);
  const std::int64_t step =
      begun < 0.0 ? 0 : std::min(1 + static_cast<std::int64_t>(begun / beginning.sum()), steps_ - 1);
  std::vector<std::uint8_t> modes(static_cast<std::size_t>(step) + 1, static_cast<std::uint8_t>(mode));
  for (auto k = static_cast<std::size_t>(step); k > 0; --k)
    modes[k - 1] = chosen(k + 1 == modes.size() ? beginning : before(of.chain, modes[k]), uniform());
  return std::make_shared<GivenModes>(GivenModes{places_[place].stream, of.chances, std::move(modes)});
}

void RareLosses::weights(const WhiteNoise& noise, std::uint64_t first, std::size_t count, double* weights) const {
  std::fill_n(weights, count, 0.0);
  std::vector<double> uniforms(count);
  std::vector<std::uint8_t> modes(count);
  for (auto next = rare_.begin(); next != rare_.end();) {
    const Place& place = places_[next->first];
    std::vector<double> shares(static_cast<std::size_t>(place.of->chain.modes()), 0.0);
    for (const std::size_t of = next->first; next != rare_.end() && next->first == of; ++next)
      shares[static_cast<std::size_t>(next->second)] = 1.0 / place.of->begins(next->second);
    const ModeChances& chances = *place.of->chances;
    for (std::int64_t step = 0; step < steps_; ++step) {
      noise.fill_uniform({place.stream, step, Purpose::loss}, first, count, uniforms.data());
      for (std::size_t s = 0; s < count; ++s) {
        const std::uint8_t mode = step > 0 ? chances.after(modes[s], uniforms[s]) : chances.first(uniforms[s]);
        if (step == 0 || mode != modes[s]) weights[s] += shares[mode];
        modes[s] = mode;
      }
    }
  }
  for (std::size_t s = 0; s < count; ++s)
    weights[s] = weights[s] > 0.0 ? static_cast<double>(rare_.size()) / weights[s] : kInfinity;
}

RareLosses::Unseen RareLosses::unseen(std::size_t paths) const {
  double alone = 0.0, beside = 0.0, least = kInfinity;
  for (const Place& place : places_) {
    for (Eigen::Index mode = 0; mode < place.of->chain.modes(); ++mode) {
      const double begins = place.of->begins(mode);
      if (!(begins * static_cast<double>(paths) < 1.0)) continue;
      (place.of->is_drawn ? beside : alone) += begins;
      least = std::min(least, begins);
    }
  }
  return {std::min(1.0, alone + beside * (expected_ - 0.5 * beside)), 1.0 / least};
}

}  // namespace platoon
