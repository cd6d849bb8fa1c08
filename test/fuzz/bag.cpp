// Any bytes as a bag that was damaged, or never finished: what can be read of it, or a BagError.

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/bags/bag_statistics.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    platoon::statistics_of_bags({platoon::fuzz::file_of(data, size)}, true, {});
  } catch (const platoon::BagError&) {
  }
  return 0;
}
