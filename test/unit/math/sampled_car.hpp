#pragma once

#include <cmath>
#include <complex>

namespace platoon {

/// L = G K of a car with actuator lag behind a headway filter, from the partial fractions of 1 / (s^2 (lag s + 1)) and
/// without any polynomial: the reference for figures of the open loop.
struct SampledCar {
  double lag, period, kp, kd;
  double steps_of_delay;  ///< of the plant's input

  std::complex<double> loop(double w) const {
    const std::complex<double> z = std::polar(1.0, w), d = z - 1.0;
    const double decay = std::exp(-period / lag);
    const std::complex<double> plant =
        period * period * (z + 1.0) / (2.0 * d * d) - lag * period / d + lag * lag * (1.0 - decay) / (z - decay);
    return plant * (kp + kd * (1.0 - 1.0 / z) / period) * std::polar(1.0, -steps_of_delay * w);
  }
};

}  // namespace platoon
