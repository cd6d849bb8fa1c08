#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/pattern_spectra.hpp"

namespace platoon {

/// Means over the circle of the spectra of linked_string.hpp, on the nodes of one quadrature; speed in metres per step.

/// P_1, ..., P_N; infinity where it leaves the range of double.
std::vector<double> variances_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed,
                                 std::size_t followers);

/// The shares of the position and of the predecessor's input in them, one follower after the other.
std::vector<double> shares_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed,
                              std::size_t followers);

/// The limit of the variance at each place of the pattern.
std::vector<double> limits_by(const PatternSpectra& spectra, const LinkedPattern& pattern, double speed);

/// The spectral radius of the pattern's matrix of loss gains; coarse_loss_gain() is on the correct side of 1, and near
/// 1 as accurate as the quadrature.
double loss_gain_by(const PatternSpectra& spectra, const LinkedPattern& pattern);
double coarse_loss_gain(const PatternSpectra& spectra, const LinkedPattern& pattern);

bool any_losses(const LinkedPattern& pattern);

}  // namespace platoon
