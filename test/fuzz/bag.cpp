// Reads any bytes as a recording: whole, without its end, up to its damage, without its checksums, all messages, and
// its end alone. Each gives messages or a BagError. With checksums, most inputs are rejected at once; without them, the
// reader parses every record, index and message.

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/ros/bags/bag_reader.hpp"
#include "stochastic_platoon/ros/bags/bag_statistics.hpp"

namespace {

template <typename Read>
void survive(const Read& read) {
  try {
    read();
  } catch (const platoon::BagError&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using platoon::Accept;
  const std::string file = platoon::fuzz::file_of(data, size);
  platoon::BagContent content;
  content.configuration = [](const auto&, const auto&) {};
  content.position = [](const auto&, const auto&) {};
  content.predecessor_position = [](const auto&, const auto&) {};
  content.error_statistics = [](const auto&, const auto&) {};
  for (const bool unverified : {false, true}) {
    for (const Accept accept : {Accept::whole, Accept::cut, Accept::damaged})
      survive([&] { platoon::read_bags({{file}, accept, unverified}, content); });
    survive([&] { platoon::statistics_of_bags({{file}, Accept::cut, unverified}, {}); });
    survive([&] { platoon::recorded_leader({{file}, Accept::cut, unverified}, 3); });
  }
  survive([&] {
    for (std::size_t chunks = 1; !platoon::read_end_of_bag(file, chunks, content);) chunks *= 4;
  });
  return 0;
}
