#include "stochastic_platoon/math/rare/gap_law.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/links/linked_responses.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

GapLaw::GapLaw(const PlatoonModel& model, std::size_t followers, std::int64_t steps)
    : followers_(followers),
      steps_(static_cast<std::size_t>(steps)),
      moments_(signal_moments(model, {kGap}, followers, steps).front()) {
  const LinkedResponses responses(model, followers_, steps_);
  period_ = responses.period();
  rows_.resize(std::min(period_, followers_));
  for (std::size_t place = 0; place < rows_.size(); ++place) {
    const auto add = [&](Kind kind, double variance, const auto& motion) {
      if (variance == 0.0) return;
      const double deviation = std::sqrt(variance);
      responses.visit_downstream(
          place, motion(), [&](std::size_t, const MeanVehicle::Sequence& before, const MeanVehicle::Passed& passed) {
            check_interruption();
            Row row(steps_);
            for (std::size_t k = 0; k < steps_; ++k)
              row[k] = deviation * static_cast<double>(before[k + 1] - passed.own.position[k + 1]);
            rows_[place][kind].push_back(std::move(row));
          });
    };
    const VehicleModel& own = responses.model(place);
    for (std::size_t n = 0; n < own.inputs.size(); ++n) {
      const LinkModel& link = own.inputs[n].link;
      add(n == 0 ? kPosition : kRadio, own.inputs[n].noise_variance, [&] {
        return responses.vehicle(place)
            .over_link(n, link.has_white_noise() ? responses.impulse() : responses.filtered_impulse(link.noise_filter))
            .own;
      });
    }
    add(kStart, own.initial_position.variance, [&] { return responses.vehicle(place).free_motion(steps_); });
  }
}

const GapLaw::Row* GapLaw::row(Kind kind, std::size_t from, std::size_t behind) const {
  const std::vector<Row>& rows = rows_[(from - 1) % period_][kind];
  return rows.empty() ? nullptr : &rows[behind];
}

std::vector<Eigen::MatrixXd> GapLaw::covariances() const {
  const auto size = static_cast<Eigen::Index>(steps_);
  std::vector<Eigen::MatrixXd> result;
  for (std::size_t i = 1; i <= followers_; ++i) {
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(size, size);
    const auto add_products = [&](Kind kind) {
      for (std::size_t j = 1; j <= std::min(period_, i); ++j) {
        const Row* const f = row(kind, j, i - j);
        if (f == nullptr) continue;
        const Eigen::Map<const Eigen::VectorXd> values(f->data(), size);
        for (Eigen::Index tau = 0; tau < size; ++tau) {
          check_interruption();
          own.col(tau) += values(tau) * values;
        }
      }
    };
    // A noise acts at every step: sums along the diagonals.
    add_products(kPosition);
    add_products(kRadio);
    for (Eigen::Index tau = 1; tau < size; ++tau) own.col(tau).tail(size - 1) += own.col(tau - 1).head(size - 1);
    add_products(kStart);
    // The sources further back act on follower i as those before act on follower i - period.
    if (i > period_) own += result[i - period_ - 1];
    result.push_back(std::move(own));
  }
  return result;
}

double GapLaw::response(const DrawName& draw, std::size_t follower, std::size_t step) const {
  const std::uint32_t from = draw.vehicle % kInputStream;
  if (from > follower || draw.purpose != Purpose::noise || draw.step >= static_cast<std::int64_t>(step)) return 0.0;
  const Kind kind = draw.step < 0 ? kStart : draw.vehicle == from ? kPosition : kRadio;
  const Row* const f = row(kind, from, follower - from);
  return f == nullptr ? 0.0 : (*f)[draw.step < 0 ? step : step - static_cast<std::size_t>(draw.step)];
}

}  // namespace platoon
