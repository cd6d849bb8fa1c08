// Reads any bytes as a sequence of messages on the wire, each after a byte for its topic, and passes them to the
// follower's, monitor's and leader's side of the delivery contract. Only messages in turn have an effect.

#include <stochastic_platoon/Progress.h>

#include <boost/make_shared.hpp>
#include <cstdlib>

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/serialized.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/delivery/credit.hpp"
#include "stochastic_platoon/run/delivery/stall_diagnosis.hpp"
#include "stochastic_platoon/run/results/run_statistics.hpp"

namespace {

using stochastic_platoon::Position;
using stochastic_platoon::Progress;

const platoon::Configuration& configuration() {
  static const platoon::Configuration made = [] {
    platoon::Configuration of_paper = platoon::parse_configuration(
        platoon::configuration_document({{"model", PLATOON_SOURCE_DIR "/config/paper.yaml"},
                                         {"followers", "2"},
                                         {"steps", "3"},
                                         {"realizations", "5"},
                                         {"batch", "2"}}));
    return of_paper;
  }();
  return made;
}

class Receivers {
public:
  Receivers()
      : statistics_(configuration(), std::optional<platoon::Checkpoint>()),
        order_(configuration().run.schedule()),
        vehicle_(configuration().model, 1, 1),
        credit_(configuration().run.schedule(), {4, 1.0, 1.0}, {"monitor"}) {}

  void take(std::size_t vehicle, const Position::ConstPtr& message) {
    const platoon::MessageDescriptor descriptor = platoon::descriptor_of(*message);
    stamp_ = platoon::later(message->header.stamp, platoon::platoon_period(0.1));
    const std::uint64_t before = statistics_.arrivals().messages();
    const platoon::DropReason drop = statistics_.take(vehicle, descriptor, platoon::positions_of(message));
    const bool counted = statistics_.arrivals().messages() == before + 1 || statistics_.arrivals().messages() == 1;
    if (drop == platoon::DropReason::none && !counted) std::abort();
    if (drop != platoon::DropReason::none && statistics_.arrivals().messages() != before) std::abort();
    if (vehicle == 0 && order_.receive(descriptor) == platoon::DropReason::none) {
      std::vector<double> out;
      if (descriptor.id.step == platoon::kInitialStep)
        vehicle_.start(descriptor.id.first_realization, descriptor.size, out);
      if (!configuration().run.schedule().is_last_step(descriptor.id.step)) vehicle_.step(message->position, out);
    }
    statistics_.saw(platoon::platoon_time(message->header.stamp.toNSec()).toNSec());
    diagnose_stall(statistics_.arrivals().latest(), configuration().run.schedule(),
                   configuration().run.pipeline_depth());
  }

  void take(const Progress& message) {
    const platoon::Acknowledgement report{message.attempt, message.first_realization, message.step};
    if (!platoon::may_be_reported(configuration().run.schedule(), report)) return;
    credit_.acknowledge("monitor", report, time_, message.messages);
    time_ += 0.5;
    credit_.retry_if_stalled(time_);
    for (int step = 0; step < 100 && credit_.next(time_); ++step) {
      if (step == 99) std::abort();  // beyond the window
    }
  }

private:
  platoon::RunStatistics statistics_;
  platoon::MessageOrder order_;
  platoon::FollowerVehicle vehicle_;
  platoon::Credit credit_;
  ros::Time stamp_;
  double time_ = 0.0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(reinterpret_cast<const char*>(data), size);
  ros::serialization::IStream stream(reinterpret_cast<std::uint8_t*>(&bytes[0]), static_cast<std::uint32_t>(size));
  Receivers receivers;
  try {
    while (stream.getLength() > 0) {
      std::uint8_t topic;
      stream.next(topic);
      if (topic % 4 == 3) {
        Progress message;
        ros::serialization::deserialize(stream, message);
        receivers.take(message);
      } else {
        const auto message = boost::make_shared<Position>();
        const std::string rest(reinterpret_cast<const char*>(stream.getData()), stream.getLength());
        // roscpp would allocate the announced size.
        if (!platoon::holds_its_arrays(ros::message_traits::datatype<Position>(), rest)) return 0;
        ros::serialization::deserialize(stream, *message);
        receivers.take(topic % 4, message);
      }
    }
  } catch (const ros::serialization::StreamOverrunException&) {
  }
  return 0;
}
