// Normals per second on one core. Prints JSON.

#include <chrono>
#include <cstdio>
#include <vector>

#include "stochastic_platoon/math/noise/white_noise.hpp"

int main() {
  constexpr std::size_t kBatch = 8192;
  constexpr int kRounds = 4000;
  const platoon::WhiteNoise noise(1);
  std::vector<double> normals(kBatch);
  double sum = 0.0;
  const auto began = std::chrono::steady_clock::now();
  for (int k = 0; k < kRounds; ++k) {
    noise.fill({1, k}, 0, kBatch, normals.data());
    sum += normals[static_cast<std::size_t>(k) % kBatch];
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  std::printf("{\"normals_per_second\": %.6g, \"check\": %.3g}\n", kRounds * static_cast<double>(kBatch) / seconds,
              sum);
}
