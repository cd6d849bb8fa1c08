#include "simulation/process.hpp"

#include <filesystem>
#include <utility>

#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon::simulation {

namespace {

std::string name_of(Process::Program program, std::uint32_t index) {
  switch (program) {
    case Process::Program::leader:
      return std::string(kNamespace) + "/vehicle_0";
    case Process::Program::channel:
      return std::string(kNamespace) + "/channel";
    case Process::Program::monitor:
      return std::string(kNamespace) + "/monitor";
    case Process::Program::follower:
      break;
  }
  return std::string(kNamespace) + "/vehicle_" + std::to_string(index);
}

}  // namespace

Process::Process(World& world, Machine& machine, Program program, std::uint32_t index, bool kept)
    : world_(world), machine_(machine), program_(program), index_(index), kept_(kept), name_(name_of(program, index)) {}

Process::~Process() {
  if (runs()) kill();
}

void Process::start() {
  node_ = std::make_unique<Node>(world_, name_);
  try {
    world_.as(node_.get(), [this] { construct(); });
  } catch (const std::exception& error) {
    world_.died(*node_, error.what());
  }
}

void Process::construct() {
  const ros::NodeHandle platoon(kNamespace);
  const std::optional<Configuration> configuration = read_configuration(platoon);
  files_.clear();
  if (program_ == Program::follower) {
    const bool takes_part = configuration && index_ <= configuration->run.followers;
    follower_ =
        std::make_unique<Follower>(platoon, takes_part ? configuration : std::nullopt, index_, kept_, MessagePool());
    return;
  }
  const RunOptions& run = configuration.value().run;
  if (program_ == Program::leader) {
    leader_ = std::make_unique<Leader>(platoon, *configuration, superseded());
  } else if (program_ == Program::monitor) {
    files_ = {std::filesystem::absolute(run.output).string() + "/"};
    monitor_ = std::make_unique<Monitor>(
        platoon, *configuration, [&platoon](std::size_t) { return platoon; }, superseded());
  } else {
    if (!run.record.empty()) {
      files_ = {std::filesystem::absolute(run.record).string()};
      recorder_ = std::make_unique<Recorder>(platoon, *configuration, superseded());
    }
    const auto followers = static_cast<std::uint32_t>(run.followers);
    channel_ = std::make_unique<Channel>(platoon, *configuration, 1, followers, MessagePool(),
                                         std::make_shared<Snapshots>(platoon, kPredecessorSnapshotTopic, followers),
                                         superseded());
  }
}

// The component starts over as soon as it has returned to its main.
RunMembership::Join Process::superseded() {
  return [this](const Configuration&) {
    world_.after(world_.uniform(0.0, 0.1), node_.get(), [this] {
      world_.after(0.0, nullptr, [this, number = node_->number()] {
        if (!runs() || node_->number() != number) return;
        stop();
        start();
      });
    });
    return false;
  };
}

void Process::destroy() {
  world_.as(node_.get(), [this] {
    leader_.reset();
    channel_.reset();
    recorder_.reset();
    follower_.reset();
    monitor_.reset();
  });
  node_.reset();
}

void Process::stop() {
  try {
    world_.as(node_.get(), [this] {
      if (monitor_) monitor_->stop();
      if (recorder_) recorder_->stop();
    });
  } catch (const std::exception& error) {
    return world_.died(*node_, error.what());
  }
  destroy();
}

void Process::kill() {
  machine_.kill(files_, [this] { destroy(); });
}

void Process::fail() {
  destroy();
}

void Process::start_again(std::function<bool()> is_due) {
  constexpr double kRespawnDelay = 0.2;
  world_.after(kRespawnDelay + world_.uniform(0.02, 0.4), nullptr, [this, is_due = std::move(is_due)] {
    if (!runs() && is_due()) start();
  });
}

}  // namespace platoon::simulation
