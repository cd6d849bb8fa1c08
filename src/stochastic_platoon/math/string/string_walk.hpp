#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"

namespace platoon {

/// A walk along a string from vehicle to vehicle, which carries the spectra of their positions.
class StringWalk {
public:
  virtual ~StringWalk() = default;
  virtual std::unique_ptr<StringWalk> clone() const = 0;

  /// What each input of the next follower adds to the spectrum of its position.
  virtual std::vector<Eigen::ArrayXd> added() = 0;

  /// Passes the next follower, which adds this in all.
  virtual void pass(Eigen::ArrayXd added) = 0;

  /// The variance of the tracking error of the follower that was passed last.
  virtual double error_variance() const = 0;

  /// The variances of a signal of this follower, and of the change of the signal from step to step.
  virtual std::array<double, 2> moments(const Signal& signal) const = 0;
};

/// An endless string whose gain is below 1, of one pattern. Its losses add to the spectra a nonnegative map of what
/// drives them, the sum over all patterns in front; the loss gain is the spectral radius of this map.
class EndlessString {
public:
  virtual ~EndlessString() = default;

  /// What the places add, without what losses scatter from the vehicles in front.
  virtual std::vector<Eigen::ArrayXd> noise() const = 0;

  /// Number of drives; 0 without losses.
  virtual Eigen::Index dimensions() const = 0;

  /// The drives in a string whose places add this.
  virtual Eigen::VectorXd drives(const std::vector<Eigen::ArrayXd>& added) const = 0;

  /// Adds what the losses scatter by these drives.
  virtual void add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const = 0;

  /// A walk from the first place on, behind patterns whose places add this.
  virtual std::unique_ptr<StringWalk> walk_behind(const std::vector<Eigen::ArrayXd>& added) const = 0;

  double loss_gain() const;
  /// On its exact side of 1 at less cost, to this share of its distance from 1.
  double loss_gain_beside_one(double share_of_distance) const;

  /// What the places add, losses included; the loss gain must be below 1.
  std::vector<Eigen::ArrayXd> added() const;

  /// The variances of the tracking errors at the places, which add this.
  std::vector<double> variances(const std::vector<Eigen::ArrayXd>& added) const;

protected:
  EndlessString(std::size_t places, Eigen::Index nodes) : nothing_(places, Eigen::ArrayXd::Zero(nodes)) {}

private:
  std::vector<Eigen::ArrayXd> nothing_;
  Eigen::VectorXd passed_on(const Eigen::VectorXd& given) const;
};

}  // namespace platoon
