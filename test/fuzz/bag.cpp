// Reads any bytes as a recording: whole, without its end, up to its damage, without its checksums, all messages, and
// its end alone. Each gives messages or a BagError. With checksums, most inputs are rejected at once; without them, the
// reader parses every record, index and message.

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/ros/bags/bag_stream.hpp"

namespace {

template <typename Read>
void survive(const Read& read) {
  try {
    read();
  } catch (const platoon::BagError&) {
  }
}

template <typename Messages>
void exhaust(Messages messages) {
  while (messages.next()) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using platoon::Accept;
  const std::string file = platoon::fuzz::file_of(data, size);
  const auto any_topic = [](const auto&) { return true; };
  for (const bool unverified : {false, true}) {
    for (const Accept accept : {Accept::whole, Accept::cut, Accept::damaged})
      survive([&] { exhaust(platoon::BagStream({{file}, accept, unverified}, any_topic)); });
    survive([&] { platoon::statistics_of_bags({{file}, Accept::cut, unverified}, {}); });
    survive([&] { platoon::recorded_leader({{file}, Accept::cut, unverified}, 3); });
  }
  survive([&] {
    for (std::size_t chunks = 1, whole = 0; whole == 0; chunks *= 4) {
      platoon::RecordedMessages end(file, {{file}, Accept::damaged}, any_topic);
      whole = end.skip_to_last_chunks(chunks) ? 1 : 0;
      exhaust(std::move(end));
    }
  });
  return 0;
}
