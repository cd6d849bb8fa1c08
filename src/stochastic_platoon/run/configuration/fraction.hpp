#pragma once

#include <Eigen/Dense>
#include <nlohmann/json.hpp>

#include "stochastic_platoon/math/model/transfer_function.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads {numerator: [..], denominator: [..]}, by descending powers of z. Reports all problems, including unknown keys.
TransferFunction read_fraction(Section& section);

/// The same for a section that has further keys.
TransferFunction read_fraction_of(Section& section);

nlohmann::json to_json(const TransferFunction& fraction);

nlohmann::json to_list(const Eigen::VectorXd& values);

}  // namespace platoon
