#pragma once

#include <Eigen/Dense>
#include <nlohmann/json.hpp>

#include "stochastic_platoon/math/model/transfer_function.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// {numerator: [..], denominator: [..]} by descending powers of z; reports what is wrong, unknown keys among it.
TransferFunction read_fraction(Section& section);

nlohmann::json to_json(const TransferFunction& fraction);

nlohmann::json to_list(const Eigen::VectorXd& values);

}  // namespace platoon
