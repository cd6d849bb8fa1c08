// The channels into all followers. Where the run is recorded, the recorder sits beside them: every position
// passes through here anyway, so that of the 2 N + 1 recorded topics only the last vehicle's crosses a socket
// for it.

#include "stochastic_platoon/graph/channel.hpp"

#include <memory>

#include "stochastic_platoon/graph/recorder.hpp"
#include "stochastic_platoon/hosting/receiving_thread.hpp"
#include "stochastic_platoon/hosting/run_component.hpp"

namespace {

void run(ros::NodeHandle platoon, const platoon::Configuration& configuration,
         platoon::Superseded& superseded) {
  std::unique_ptr<platoon::Recorder> recorder;
  if (!configuration.run.record.empty())
    recorder = std::make_unique<platoon::Recorder>(platoon, configuration, superseded.join());
  platoon::ReceivingThread receiving_thread;
  platoon.setCallbackQueue(&receiving_thread);
  const auto followers = static_cast<std::uint32_t>(configuration.run.followers);
  const platoon::Channel channel(platoon, configuration, 1, followers, platoon::MessagePool(),
                                 superseded.join());
  superseded.spin();
  if (recorder) recorder->stop();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, {"channel"}, run);
}
