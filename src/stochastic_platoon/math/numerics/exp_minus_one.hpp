#pragma once

#include <Eigen/Core>
#include <cmath>

namespace platoon {

/// e^x - 1 of each value, accurate near zero. Eigen's own function came with version 3.4; ROS Noetic has Eigen 3.3.7.
inline Eigen::ArrayXd exp_minus_one(const Eigen::ArrayXd& values) {
  return values.unaryExpr([](double value) { return std::expm1(value); });
}

}  // namespace platoon
