#include "simulation/process.hpp"

#include <filesystem>
#include <utility>

#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon::simulation {

namespace {

std::string name_of(Process::Program program, std::uint32_t index) {
  const char* const names[] = {"vehicle_0", "channel", "vehicle_", "monitor", "platoon", "player", "vehicle_replay"};
  const bool is_follower = program == Process::Program::follower;
  return std::string(kNamespace) + "/" + names[static_cast<int>(program)] + (is_follower ? std::to_string(index) : "");
}

// The beginnings of the names of a recording's files.
std::vector<std::string> files_of(const std::string& record) {
  if (record.empty()) return {};
  const std::string file = std::filesystem::absolute(record).string();
  return {file, file.substr(0, file.size() - 4) + "_"};
}

}  // namespace

Process::Process(World& world, Machine& machine, Program program, std::uint32_t index, bool kept,
                 std::vector<std::string> bags)
    : world_(world),
      machine_(machine),
      program_(program),
      index_(index),
      kept_(kept),
      bags_(std::move(bags)),
      name_(name_of(program, index)) {}

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
  } else if (program_ == Program::platoon) {
    constexpr std::size_t kThreads = 2;  // their queues are that of the node here
    files_ = {std::filesystem::absolute(run.output).string() + "/"};
    for (const std::string& file : files_of(run.record)) files_.push_back(file);
    platoon_ = std::make_unique<OneProcess>(platoon, *configuration, kThreads, superseded());
  } else if (program_ == Program::player) {
    const double rate = world_.happens(0.3) ? world_.uniform(500.0, 5000.0) : 0.0;
    player_ = std::make_unique<Player>(platoon, ros::NodeHandle(name_), *configuration, PlayerOptions{{bags_}, rate});
  } else if (program_ == Program::vehicle_replay) {
    constexpr double kPatience = 1000.0;  // [s]
    vehicle_replay_ =
        std::make_unique<VehicleReplay>(platoon, *configuration, BagSource{bags_}, index_, false, kPatience);
  } else {
    if (!run.record.empty()) {
      files_ = files_of(run.record);
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
    platoon_.reset();
    player_.reset();
    vehicle_replay_.reset();
  });
  node_.reset();
}

void Process::stop() {
  try {
    world_.as(node_.get(), [this] {
      if (monitor_) monitor_->stop();
      if (recorder_) recorder_->stop();
      if (platoon_) platoon_->stop();
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
