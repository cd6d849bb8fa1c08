#include "stochastic_platoon/run/configuration/fraction.hpp"

#include <stdexcept>

namespace platoon {

TransferFunction read_fraction(Section& section) {
  TransferFunction fraction = read_fraction_of(section);
  section.reject_unknown_keys();
  return fraction;
}

TransferFunction read_fraction_of(Section& section) {
  const Eigen::VectorXd numerator = section.numbers("numerator", kLongestRow);
  const Eigen::VectorXd denominator = section.numbers("denominator", kLongestRow);
  try {
    if (denominator.cwiseAbs().maxCoeff() > 0.0) return {numerator, denominator};
    section.reject("denominator", "all zero", "a polynomial other than 0");
  } catch (const std::invalid_argument& error) {
    section.report(error.what());
  }
  return {numerator, Eigen::VectorXd::Ones(1)};
}

nlohmann::json to_list(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

nlohmann::json to_json(const TransferFunction& fraction) {
  return {{"numerator", to_list(fraction.numerator())}, {"denominator", to_list(fraction.denominator())}};
}

}  // namespace platoon
