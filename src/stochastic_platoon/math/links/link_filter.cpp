#include "stochastic_platoon/math/links/link_filter.hpp"

#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {

LinkFilter::LinkFilter(const LinkModel& link, double noise_variance, const LinkFilter* known)
    : link_(link),
      noise_variance_(noise_variance),
      losses_(known != nullptr && known->link_.loss == link.loss
                  ? known->losses_
                  : std::make_shared<LossFilter>(link.loss.value_or(LossModel()))) {}

double LinkFilter::noise(const CirclePoint& point) const {
  const std::complex<double> z(point.offset + (point.centre == Centre::kOne ? 1.0L : -1.0L));
  const double coloured = link_.has_white_noise() ? 1.0 : std::norm(link_.noise_filter(z));
  return coloured * noise_variance_ + link_.quantisation_step * link_.quantisation_step / 12.0;
}

int LinkFilter::noise_zeros() const {
  if (link_.quantisation_step > 0.0) return 0;
  if (noise_variance_ == 0.0) return ZerosAtZero::kNone;
  const Polynomial& filter = link_.noise_filter.numerator();
  return leading_zeros(delta_form(filter), delta_form(filter.cwiseAbs()), 0);
}

std::vector<std::complex<double>> LinkFilter::noise_frequencies() const {
  const CirclePolynomial filter = delta_form(link_.noise_filter.denominator());
  if (filter.size() < 2) return {};
  return frequencies_of(zeros(filter));
}

}  // namespace platoon
