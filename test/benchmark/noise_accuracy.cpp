// noise_accuracy [BLOCKS]: prints the largest errors of the noise's functions against quadruple precision, in units
// of the last place, for the words of so many blocks (10^8: some minutes) and for arguments at the ends.

#include <quadmath.h>

#include <cstdio>
#include <cstdlib>

#include "stochastic_platoon/math/noise/white_noise.cpp"

namespace platoon {
namespace {

__extension__ typedef __float128 Quad;

struct Largest {
  double error = 0.0;
  double argument = 0.0;

  void take(double value, Quad exact, double x) {
    if (exact == 0) return;
    const int exponent = ilogbq(fabsq(exact));
    const double ulps = static_cast<double>(scalbnq(fabsq(static_cast<Quad>(value) - exact), 52 - exponent));
    if (ulps > error) *this = {ulps, x};
  }
};

struct Errors {
  Largest log, sin, cos;
  double normal = 0.0;  // absolute, relative to the radius, in 2^-53

  void take(std::uint64_t w1, std::uint64_t w2) {
    const double u = 2.0 - in_one_to_two(w1), x = in_one_to_two(w2) - 1.5;
    const Quad exact_log = -logq(u), angle = 2 * atanq(1) * x, exact_sin = sinq(angle), exact_cos = cosq(angle);
    log.take(minus_log<Fused>(u), exact_log, u);
    sin.take(sin_quarters<Fused>(x), exact_sin, x);
    cos.take(cos_quarters<Fused>(x), exact_cos, x);
    double normals[2];
    fastest().box_muller(&w1, &w2, 1, normals);
    const Quad radius = sqrtq(exact_log), even = radius * (exact_cos - exact_sin),
               odd = radius * (exact_cos + exact_sin);
    if (radius == 0) return;
    for (const Quad error : {std::abs(normals[0]) - even, std::abs(normals[1]) - odd})
      normal = std::max(normal, static_cast<double>(scalbnq(fabsq(error / radius) / sqrtq(2), 53)));
  }
};

}  // namespace
}  // namespace platoon

int main(int argc, char** argv) {
  const auto arguments = static_cast<std::uint64_t>(argc > 1 ? std::atof(argv[1]) : 1e6);
  platoon::Errors errors;
  platoon::detail::Words w1, w2;
  for (std::uint64_t j = 0; j < 4096; ++j) {
    for (const unsigned long long end : {0ULL + j, (1ULL << 52) - 1 - j, (1ULL << 51) - 2048 + j,
                                         0x4afb0ccc06219ULL - 2048 + j})  // u = 1, 0, 1/2, sqrt(1/2)
      errors.take(end, end);
  }
  for (std::uint64_t done = 0; done < arguments; done += platoon::detail::kBlocks) {
    platoon::fastest().draw_words(1, {1, 0}, done, platoon::detail::kBlocks, &w1, &w2);
    for (std::size_t j = 0; j < platoon::detail::kBlocks; ++j) errors.take(w1[j], w2[j]);
  }
  const auto print = [](const char* name, const platoon::Largest& largest) {
    std::printf("%s: %.3f units in the last place, at %.17g\n", name, largest.error, largest.argument);
  };
  print("-ln u", errors.log);
  print("sin(x pi / 2)", errors.sin);
  print("cos(x pi / 2)", errors.cos);
  std::printf("normals: %.3f 2^-53 sqrt(-2 ln u)\n", errors.normal);
}
