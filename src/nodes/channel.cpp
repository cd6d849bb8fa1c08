// The channels into all followers. If the run is recorded, this node also hosts the recorder: every position passes
// through here anyway, so that only one of the 2 N + 1 recorded topics, the last vehicle's, needs a socket for it.

#include "stochastic_platoon/ros/nodes/channel.hpp"

#include <memory>

#include "stochastic_platoon/ros/hosting/receiving_thread.hpp"
#include "stochastic_platoon/ros/hosting/run_component.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/nodes/recorder.hpp"

namespace {

void run_channel(ros::NodeHandle platoon, const platoon::Configuration& configuration,
                 platoon::Superseded& superseded) {
  std::unique_ptr<platoon::Recorder> recorder;
  if (!configuration.run.record.empty())
    recorder = std::make_unique<platoon::Recorder>(platoon, configuration, superseded.join());
  const ros::NodeHandle watched = platoon;
  platoon::ReceivingThread receiving_thread;
  platoon.setCallbackQueue(&receiving_thread);
  const auto followers = static_cast<std::uint32_t>(configuration.run.followers);
  const auto received = std::make_shared<platoon::Snapshots>(watched, platoon::kPredecessorSnapshotTopic, followers);
  const platoon::Channel channel(platoon, configuration, 1, followers, platoon::MessagePool(), received,
                                 superseded.join());
  platoon::Diagnostics diagnostics(watched);
  diagnostics.add("channel", platoon::VitalSigns(channel.sources()));
  if (recorder) diagnostics.add("recorder", platoon::VitalSigns(recorder->sources()));
  superseded.spin();
  if (recorder) recorder->stop();
}

}  // namespace

int channel_main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv,
      {"channel",
       "The links into all followers; records, if the run is recorded. platoon.launch starts it.\nExample: rosrun stochastic_platoon channel __ns:=platoon"},
      run_channel);
}
