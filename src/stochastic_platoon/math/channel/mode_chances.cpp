#include "stochastic_platoon/math/channel/mode_chances.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/model/loss_chain.hpp"

namespace platoon {

ModeChances::ModeChances(const LossChain& chain) : arrived_(static_cast<std::size_t>(chain.arrived())) {
  const auto shares = [&chain](const Eigen::VectorXd& probabilities) {
    std::vector<Share> result;
    double sum = 0.0;
    for (Eigen::Index i = 0; i < chain.modes(); ++i) {
      const Eigen::Index mode = i < chain.lost() ? chain.arrived() + i : i - chain.lost();
      const double upto = sum + probabilities(mode);
      if (upto > sum) result.push_back({upto, static_cast<std::uint8_t>(mode)});  // else no draw leads to it
      sum = upto;
    }
    result.back().upto = 1.0;
    return result;
  };
  for (Eigen::Index mode = 0; mode < chain.modes(); ++mode)
    modes_.push_back(shares(chain.transition().row(mode).transpose()));
  modes_.push_back(shares(chain.stationary()));
}

std::uint8_t ModeChances::after(std::size_t mode, double uniform) const {
  const std::vector<Share>& shares = modes_[mode];
  auto found = shares.begin();
  while (!(uniform < found->upto) && found + 1 != shares.end()) ++found;
  return found->mode;
}

double ModeChances::probability(std::size_t from, std::uint8_t to) const {
  double lower = 0.0;
  for (const Share& share : modes_[from]) {
    if (share.mode == to) return share.upto - lower;
    lower = share.upto;
  }
  return 0.0;
}

double ModeChances::leading(std::size_t from, std::uint8_t to, double uniform) const {
  double lower = 0.0;
  for (const Share& share : modes_[from]) {
    if (share.mode == to) return std::min(lower + uniform * (share.upto - lower), std::nextafter(share.upto, lower));
    lower = share.upto;
  }
  return uniform;
}

}  // namespace platoon
