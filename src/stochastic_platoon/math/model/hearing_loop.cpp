#include "stochastic_platoon/math/model/hearing_loop.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/zeros.hpp"

namespace platoon {

using Complex = std::complex<long double>;

HearingLoop::HearingLoop(const VehicleModel& vehicle, std::size_t follower, double sample_period)
    : headway_(0.0),
      spacing_(vehicle.headway * spacing_in_vehicles(vehicle, follower)),
      speed_(own_speed_gain(vehicle, sample_period)) {
  if (!vehicle.design) throw std::invalid_argument("closed_loop: given: must be plant and controller");
  ExactTransfer controller = vehicle.design->controller.exact();
  if (vehicle.design->divide_by_one_plus_headway)
    controller.denominator = multiply(controller.denominator, {Exact(1) + Exact(vehicle.headway)});
  plant_ = std::make_shared<const ExactTransfer>(vehicle.design->plant.exact());
  controller_ = std::make_shared<const ExactTransfer>(std::move(controller));
  if (vehicle.design->headway_filter) headway_ = vehicle.headway;
  acceleration_ = vehicle.own_acceleration / (sample_period * sample_period);
  const ExactPolynomial* const parts[] = {&plant_->numerator, &plant_->denominator, &controller_->numerator,
                                          &controller_->denominator};
  for (std::size_t j = 0; j < 4; ++j) rounded_[j] = rounded_delta(*parts[j]);
}

HearingLoop::Value HearingLoop::at(const CirclePoint& point) const {
  const Complex s = point.from_one(), z = 1.0L + s, moved = s * std::conj(z);  // 1 - 1/z
  const Complex plant = evaluate(rounded_[0], s), open = evaluate(rounded_[1], s) * turned(z, plant_->delay),
                controller = evaluate(rounded_[2], s) * turned(z, -controller_->delay),
                of_controller = evaluate(rounded_[3], s);
  const Complex filter = 1.0L + static_cast<long double>(headway_) * moved,
                policy = 1.0L + static_cast<long double>(spacing_) * moved,
                own =
                    static_cast<long double>(speed_) * moved - static_cast<long double>(acceleration_) * moved * moved;
  const Complex closed = filter * open * of_controller + controller * plant * policy + own * plant * of_controller;
  return {controller * plant / closed, plant * of_controller / closed, open / plant};
}

std::vector<Complex> HearingLoop::poles() const {
  // The denominator of y_i times z^2, with as many more powers of z as make it a polynomial.
  const std::ptrdiff_t q = controller_->delay, least = std::min<std::ptrdiff_t>({plant_->delay + q + 1, 1, q});
  const auto times_z = [least](const ExactPolynomial& p, std::ptrdiff_t count) {
    return times_power_of_z(p, count - std::min<std::ptrdiff_t>(least, 0));
  };
  const ExactPolynomial open = multiply(plant_->denominator, controller_->denominator),
                        forward = multiply(plant_->numerator, controller_->numerator),
                        of_own = multiply(plant_->numerator, controller_->denominator);
  ExactPolynomial sum = times_z(multiply(open, {Exact(1), Exact(1) + Exact(headway_)}), plant_->delay + q + 1);
  sum = add(sum, times_z(multiply(forward, {Exact(1), Exact(1) + Exact(spacing_)}), 1));
  sum = add(sum, times_z(multiply(of_own, {Exact(0), Exact(speed_)}), q + 1));
  sum = add(sum, times_z(multiply(of_own, {Exact(0), Exact(0), Exact(-acceleration_)}), q));
  return zeros(sum);
}

double HearingLoop::spectral_radius() const {
  return platoon::spectral_radius(poles());
}

ExactTransfer HearingLoop::opened() const {
  const ExactPolynomial of_position = multiply(controller_->numerator,
                                               times_power_of_z({Exact(1), Exact(1) + Exact(spacing_)}, 1)),
                        of_own = add(times_power_of_z({Exact(0), Exact(speed_)}, 1),
                                     {Exact(0), Exact(0), Exact(-acceleration_)});
  // 1/z^2 and the longer of the two delays are taken out.
  const std::ptrdiff_t q = controller_->delay, taken = std::max<std::ptrdiff_t>(q, 0);
  ExactTransfer open{
      multiply(plant_->numerator, add(times_power_of_z(of_position, taken - q),
                                      times_power_of_z(multiply(controller_->denominator, of_own), taken))),
      multiply(plant_->denominator, controller_->denominator), plant_->delay + taken + 2};
  if (headway_ == 0.0) return open;
  open.denominator = multiply(open.denominator, {Exact(1), Exact(1) + Exact(headway_)});
  --open.delay;
  return open;
}

Complex sent_value(const Input& input, const CirclePoint& point, Complex of_source, double sample_period) {
  const Complex z = 1.0L + point.from_one(), moved = point.from_one() * std::conj(z) / Complex(sample_period);
  Complex value = power(std::conj(z), static_cast<std::size_t>(input.link.delay));
  if (input.signal == InputSignal::speed) value *= moved;
  if (input.signal == InputSignal::acceleration) value *= moved * moved;
  if (input.signal == InputSignal::input) value *= of_source;
  return value;
}

}  // namespace platoon
