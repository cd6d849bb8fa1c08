#pragma once

#include <cstddef>

namespace platoon {

/// out = factor in.
void set_multiple(double factor, const double* in, std::size_t count, double* out);

/// out += factor in.
void add_multiple(double factor, const double* in, std::size_t count, double* out);

}  // namespace platoon
