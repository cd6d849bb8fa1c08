#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/loss_scatter.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/string/string_theory.hpp"

namespace platoon {

/// Spectra along a string whose vehicles hear any vehicles ahead, at n / 2 equally spaced nodes. With T_j = N_j
/// T_L z^-m S_j from the position of the source of input j to the own one (S_j = 1, (1 - 1/z) / T_s, its square, or 1 /
/// G of the source), T_ia the sum of T_j over the inputs from vehicle a, sums of a and b over the vehicles heard, and
/// for every packet g and u of its losses (see LossKernel), \f[ \Phi_{ib} = \sum_a T_{ia} \Phi_{ab}, \qquad \Phi_{ii} =
/// \sum_{a,b} T_{ia} \Phi_{ab} T_{ib}^* + E_i, \f] \f[ E_i = \sum_j |N_j T_L|^2 N_d + \sum_{packets} \langle g |u|^2
/// (|\textstyle\sum_j N_j(w) z^{-m} S_j(\nu)|^2
///         \Phi_s + \sum_j |N_j|^2 N_d) \rangle + (\text{the platoon's own motion}). \f]
/// The leader has no spectrum.
class HearingSpectra {
public:
  HearingSpectra(const PlatoonModel& model, std::size_t n) : HearingSpectra(model, SpectralNodes(n)) {}

  /// At other nodes, for strings without losses.
  HearingSpectra(const PlatoonModel& model, SpectralNodes nodes);

  /// One vehicle at its place.
  struct Vehicle {
    struct Heard {
      std::size_t distance;                 ///< of the source; 0: vehicle 0
      Eigen::ArrayXcd own, sent, transfer;  ///< N_j; z^-m S_j; T_j
      Eigen::ArrayXd noise;                 ///< N_d
      double steady;                        ///< drive of the platoon's own motion
    };
    struct Packet {
      std::vector<std::size_t> inputs;
      std::shared_ptr<const LossScatter> losses;
      Eigen::ArrayXcd passed;  ///< T_L
    };
    std::vector<Heard> inputs;
    std::vector<Packet> packets;
    Eigen::ArrayXcd policy;  ///< from the own position to y + h D y
  };
  const Vehicle& vehicle(std::size_t follower) const;

  /// The cross spectra of the latest vehicles, the nearest first.
  using Window = std::vector<std::vector<Eigen::ArrayXcd>>;
  Window nothing() const;
  std::size_t reach() const { return reach_; }

  /// T_ia by the distance i - a, from 1 on; none from the leader.
  std::vector<Eigen::ArrayXcd> transfers(std::size_t follower) const;

  /// E_i behind these spectra: what each input adds by its noise and its losses, those of a packet at the first of its
  /// inputs.
  std::vector<Eigen::ArrayXd> added(std::size_t follower, const Window& ahead) const;

  /// What drives the losses of a packet, of the spectra that it is sent alone: the drives of its link (see
  /// LossScatter), or, as those of cross spectra may be negative, the spectrum that the losses of several inputs add.
  /// None from the leader.
  Eigen::Index dimensions(const Vehicle& own, const Vehicle::Packet& packet) const;
  Eigen::VectorXd drives(const Vehicle& own, const Vehicle::Packet& packet, const Window& ahead) const;

  /// The spectrum that the losses of a packet add by drives, of which there are some.
  Eigen::ArrayXd of_drives(const Vehicle& own, const Vehicle::Packet& packet, const Eigen::VectorXd& drives) const;

  /// What a quantity takes of the positions of a follower and of its predecessor.
  struct Filters {
    Eigen::ArrayXcd own, predecessor;
  };

  /// The spectra of a follower and its predecessor, and Phi_{i,i-1}.
  struct Pair {
    Eigen::ArrayXd own, predecessor;
    Eigen::ArrayXcd cross;
  };
  double variance(const Pair& pair, const Filters& of) const;

  /// Puts follower i in front of the window.
  Pair advance(std::size_t follower, const Eigen::ArrayXd& added, Window& window) const;

  /// Those of a signal; the control input takes 1 / G of the own position.
  Filters filters(const Signal& signal, std::size_t follower) const;

  /// 1 - 1 / z at each node.
  const Eigen::ArrayXcd& moved() const { return moved_; }

private:
  Eigen::ArrayXd scattered(const Vehicle& own, const Vehicle::Packet& packet, const Window& ahead,
                           bool with_noise) const;
  std::shared_ptr<const LossScatter> scatter(const LossModel& loss) const;

  PlatoonModel model_;
  SpectralNodes nodes_;
  Eigen::ArrayXcd moved_;
  std::size_t reach_;
  double speed_;  ///< [m] per step
  mutable std::map<std::pair<std::size_t, std::size_t>, Vehicle>
      vehicles_;  ///< by place in the pattern and near the leader
  mutable std::vector<std::pair<LossModel, std::shared_ptr<const LossScatter>>> scatters_;
};

/// A walk where vehicles hear any vehicles ahead, with their cross spectra.
class HearingWalk : public StringWalk {
public:
  /// From the leader on. `spectra` must outlive the object.
  explicit HearingWalk(const HearingSpectra& spectra) : HearingWalk(spectra, 1, spectra.nothing()) {}

  /// From this follower on, behind these vehicles.
  HearingWalk(const HearingSpectra& spectra, std::size_t next, HearingSpectra::Window ahead)
      : spectra_(&spectra), next_(next), ahead_(std::move(ahead)) {}

  std::unique_ptr<StringWalk> clone() const override { return std::make_unique<HearingWalk>(*this); }
  std::vector<Eigen::ArrayXd> added() override { return spectra_->added(next_, ahead_); }
  void pass(Eigen::ArrayXd added) override { last_ = spectra_->advance(next_++, added, ahead_); }
  double error_variance() const override;
  std::array<double, 2> moments(const Signal& signal) const override;

private:
  const HearingSpectra* spectra_;
  std::size_t next_;
  HearingSpectra::Window ahead_;
  HearingSpectra::Pair last_;
};

}  // namespace platoon
