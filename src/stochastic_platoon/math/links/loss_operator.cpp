#include "stochastic_platoon/math/links/loss_operator.hpp"
#include "stochastic_platoon/math/model/input.hpp"

#include <algorithm>
#include <utility>

namespace platoon {

LossOperator::LossOperator(const StringSpectra& spectra) : spectra_(spectra), margin_(spectra.pattern_margin()) {
  for (std::size_t j = 0; j < spectra.size(); ++j) {
    first_.emplace_back(spectra[j].inputs.size(), -1);
    for (std::size_t link = 0; link < spectra[j].inputs.size(); ++link) {
      const LossScatter* const losses = spectra[j].inputs[link].losses.get();
      if (losses == nullptr) continue;
      auto same = std::find_if(alike_.begin(), alike_.end(), [losses](const Alike& of) { return of.losses == losses; });
      if (same == alike_.end()) same = alike_.insert(alike_.end(), Alike{losses, 0, {}});
      same->links.emplace_back(j, link);
    }
  }
  for (Alike& of : alike_) {
    of.first = dimensions_;
    for (const auto& [place, link] : of.links) {
      first_[place][link] = dimensions_;
      dimensions_ += of.losses->dimensions();
    }
  }
}

void LossOperator::add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const {
  for (const Alike& of : alike_) {
    const Eigen::Map<const Eigen::MatrixXd> alike(drives.data() + of.first, of.losses->dimensions(),
                                                  static_cast<Eigen::Index>(of.links.size()));
    const Eigen::MatrixXd scattered = (*of.losses)(alike);
    for (std::size_t k = 0; k < of.links.size(); ++k) {
      const auto& [place, link] = of.links[k];
      added[place] += spectra_[place].inputs[link].own * scattered.col(static_cast<Eigen::Index>(k)).array();
    }
  }
}

Eigen::VectorXd LossOperator::drives(const std::vector<Eigen::ArrayXd>& added) const {
  Eigen::VectorXd result(dimensions_);
  Eigen::ArrayXd spectrum = spectra_.in_front(added, margin_);
  for (std::size_t j = 0; j < added.size(); ++j) {
    for (std::size_t link = 0; link < first_[j].size(); ++link) {
      if (first_[j][link] < 0) continue;
      const LossScatter& losses = *spectra_[j].inputs[link].losses;
      result.segment(first_[j][link], losses.dimensions()) =
          losses.drives(spectra_.at_link(j, link, spectrum).matrix());
    }
    spectrum *= spectra_[j].gain;  // in place: GCC 12 suspects the other form of using freed memory
    spectrum += added[j];
  }
  return result;
}

std::vector<Eigen::VectorXd> LossOperator::spectra_of(const Eigen::VectorXd& drives) const {
  std::vector<Eigen::VectorXd> found;
  for (const Alike& of : alike_) {
    const Eigen::Index count = of.losses->dimensions();
    if (count != spectra_.nodes()) continue;  // independent losses
    for (std::size_t k = 0; k < of.links.size(); ++k)
      found.push_back(drives.segment(of.first + static_cast<Eigen::Index>(k) * count, count));
  }
  return found;
}

Eigen::VectorXd LossOperator::operator()(const Eigen::VectorXd& given) const {
  std::vector<Eigen::ArrayXd> added(spectra_.size(), Eigen::ArrayXd::Zero(spectra_.nodes()));
  add(given, added);
  return drives(added);
}

}  // namespace platoon
