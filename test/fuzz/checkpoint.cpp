// Reads any bytes as a checkpoint, unchanged and as content with a correct digest: gives a valid checkpoint or a
// std::runtime_error.

#include <cstdlib>
#include <stdexcept>

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/digest.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"

namespace {

void read(const std::string& bytes) {
  platoon::fuzz::folder().file("checkpoint.cbor", bytes);
  try {
    const std::optional<platoon::Checkpoint> found = platoon::read_checkpoint(platoon::fuzz::folder().path());
    if (!found) std::abort();
    std::uint64_t end = 0, count = 0;
    for (const auto& entry : found->totals.moments.blocks()) {
      if (entry.second.range.first < end || entry.second.range.end() <= entry.second.range.first) std::abort();
      end = entry.second.range.end();
      count += entry.second.range.size();
    }
    if (found->totals.count() != count || found->totals.moments.totals().size() != found->totals.moments.cells())
      std::abort();
  } catch (const std::runtime_error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = platoon::fuzz::text_of(data, size);
  read(bytes);
  read(platoon::formatted("stochastic_platoon checkpoint 3\n%016llx\n",
                          static_cast<unsigned long long>(platoon::digest(bytes))) +
       bytes);
  return 0;
}
