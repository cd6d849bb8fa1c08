#include "stochastic_platoon/math/rare/gap_law.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/links/string_responses.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

GapLaw::GapLaw(const PlatoonModel& model, std::size_t followers, std::int64_t steps)
    : followers_(followers),
      steps_(static_cast<std::size_t>(steps)),
      moments_(signal_moments(model, {kGap}, followers, steps).front()) {
  require_normal_errors(model);
  const StringResponses responses(model, followers_, steps_);
  different_ = responses.different();
  for (std::size_t i = 1; i <= std::min(followers_, different_.count()); ++i) {
    rows_.emplace_back(vehicle(model, i).inputs.size() + 1);
    for (const StringResponses::Source& source : responses.sources(i)) {
      std::vector<Row>& rows = rows_.back()[source.input ? *source.input + 1 : 0];
      const double deviation = std::sqrt(source.variance);
      responses.visit(source, [&](std::size_t, const auto& predecessor, const auto& of) {
        rows.emplace_back(steps_);
        for (std::size_t k = 0; k < steps_; ++k)
          rows.back()[k] = deviation * static_cast<double>(predecessor[k + 1] - of.own.position[k + 1]);
      });
    }
  }
}

std::vector<Eigen::MatrixXd> GapLaw::covariances() const {
  const auto [alone, period] = different_;
  std::vector<Eigen::MatrixXd> result;
  std::deque<Eigen::MatrixXd>
      repeated;  // what the sources that repeat cause in the latest followers, a pattern of them
  for (std::size_t i = 1; i <= followers_; ++i) {
    Eigen::MatrixXd own = of_sources(alone + 1, std::min(different_.count(), i), i);
    // The sources further back act on follower i as those before act on follower i - period.
    if (repeated.size() == period) {
      own += repeated.front();
      repeated.pop_front();
    }
    repeated.push_back(own);
    if (alone > 0) own += of_sources(1, std::min(alone, i), i);
    result.push_back(std::move(own));
  }
  return result;
}

Eigen::MatrixXd GapLaw::of_sources(std::size_t first, std::size_t last, std::size_t follower) const {
  const auto size = static_cast<Eigen::Index>(steps_);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  const auto add_products = [&](const Row& row) {
    const Eigen::Map<const Eigen::VectorXd> values(row.data(), size);
    for (Eigen::Index tau = 0; tau < size; ++tau) {
      check_interruption();
      sum.col(tau) += values(tau) * values;
    }
  };
  for (std::size_t from = first; from <= last; ++from) {
    for (std::size_t kind = 1; kind < rows_[from - 1].size(); ++kind) {
      const std::vector<Row>& rows = rows_[from - 1][kind];
      if (!rows.empty()) add_products(rows[follower - from]);
    }
  }
  // A noise acts at every step: sums along the diagonals.
  for (Eigen::Index tau = 1; tau < size; ++tau) sum.col(tau).tail(size - 1) += sum.col(tau - 1).head(size - 1);
  for (std::size_t from = first; from <= last; ++from) {
    const std::vector<Row>& rows = rows_[from - 1].front();
    if (!rows.empty()) add_products(rows[follower - from]);
  }
  return sum;
}

double GapLaw::response(const DrawName& draw, std::size_t follower, std::size_t step) const {
  const std::size_t from = vehicle_of_stream(draw.vehicle), input = input_of_stream(draw.vehicle);
  if (from > follower || draw.purpose != Purpose::noise || draw.step >= static_cast<std::int64_t>(step)) return 0.0;
  const std::vector<Row>& rows = rows_[different_.of(from) - 1][draw.step < 0 ? 0 : input + 1];
  if (rows.empty()) return 0.0;
  return rows[follower - from][draw.step < 0 ? step : step - static_cast<std::size_t>(draw.step)];
}

}  // namespace platoon
