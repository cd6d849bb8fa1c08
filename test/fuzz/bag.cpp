// Any bytes as a bag that was damaged, or never finished: what can be read of it or of its end, or a BagError.

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/bags/bag_statistics.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file = platoon::fuzz::file_of(data, size);
  try {
    platoon::statistics_of_bags({file}, true, {});
  } catch (const platoon::BagError&) {
  }
  platoon::BagContent content;
  content.position = [](const auto&, const auto&) {};
  content.predecessor_position = [](const auto&, const auto&) {};
  try {
    for (std::size_t chunks = 1; !platoon::read_end_of_bag(file, chunks, content);) chunks *= 4;
  } catch (const platoon::BagError&) {
  }
  return 0;
}
