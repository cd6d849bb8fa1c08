#include "stochastic_platoon/math/string/string_walk.hpp"

#include "stochastic_platoon/math/numerics/krylov.hpp"

namespace platoon {

Eigen::VectorXd EndlessString::passed_on(const Eigen::VectorXd& given) const {
  std::vector<Eigen::ArrayXd> added = nothing_;
  add(given, added);
  return drives(added);
}

double EndlessString::loss_gain() const {
  return perron_root([this](const Eigen::VectorXd& given) { return passed_on(given); }, dimensions());
}

double EndlessString::loss_gain_beside_one(double share_of_distance) const {
  return perron_root_beside_one([this](const Eigen::VectorXd& given) { return passed_on(given); }, dimensions(),
                                share_of_distance);
}

std::vector<Eigen::ArrayXd> EndlessString::added() const {
  std::vector<Eigen::ArrayXd> added = noise();
  if (dimensions() == 0) return added;
  add(solve_one_minus([this](const Eigen::VectorXd& given) { return passed_on(given); }, drives(added)), added);
  return added;
}

std::vector<double> EndlessString::variances(const std::vector<Eigen::ArrayXd>& added) const {
  const std::unique_ptr<StringWalk> walk = walk_behind(added);
  std::vector<double> variances;
  for (const Eigen::ArrayXd& of_place : added) {
    walk->pass(of_place);
    variances.push_back(walk->error_variance());
  }
  return variances;
}

}  // namespace platoon
