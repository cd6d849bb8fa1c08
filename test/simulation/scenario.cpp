#include "simulation/scenario.hpp"

#include <ros/node_handle.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "simulation/launches.hpp"
#include "simulation/observer.hpp"
#include "simulation/process.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon::simulation {

namespace {

namespace fs = std::filesystem;

constexpr double kPatience = 300.0;       // [s] from the last fault to the end of a run
constexpr std::size_t kMostVehicles = 4;  // followers

/// A run that ends for a reason that is no fault of a simulated thing.
class Failure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Scenario {
public:
  explicit Scenario(const Plan& plan)
      : plan_(plan), random_(plan.seed * 2 + 1), world_(plan.seed), kept_(random_() % 2 == 0) {
    began_ = last_fault_ = world_.now();
    due_ = began_ + (plan_.faults.empty() ? 0.0 : plan_.faults.front().wait);
    world_.log = [this](const std::string& line) { log(line); };
    world_.died = [this](Node& node, const std::string& error) { died(node, error); };
    world_.tamper = [this](const SentTopic& topic, const ros::SerializedMessage& message) {
      return tampered(topic, message);
    };
    if (kept_) {
      for (std::uint32_t i = 1; i <= kMostVehicles; ++i)
        followers_.push_back(std::make_unique<Process>(world_, machine_, Process::Program::follower, i, true));
      for (const auto& follower : followers_) follower->start();
    }
  }

  ~Scenario() {
    end_launch(true);
    for (const auto& follower : followers_) {
      if (follower->runs()) follower->kill();
    }
  }

  Outcome run() {
    try {
      while (next_fault_ < plan_.faults.size() || launches_ == 0) launch();
    } catch (const Failure& failure) {
      outcome_.wrong = failure.what();
    } catch (const std::exception& error) {
      outcome_.wrong = std::string("exception: ") + error.what();
    }
    return std::move(outcome_);
  }

private:
  void note(const std::string& text) { outcome_.history.push_back(formatted("%.6f ", world_.now() - began_) + text); }

  void log(const std::string& line) {
    note(line);
    const std::size_t stall = line.find("run stalled: ");
    if (stall == std::string::npos) return;
    const std::string cause = line.substr(stall + 13);
    const bool is_named = cause.find("vehicle_") != std::string::npos || cause.find("recorder") != std::string::npos ||
                          cause.find("vehicles are not running") != std::string::npos;
    if (!is_named) throw Failure("a stall without a cause: " + line);
  }

  void died(Node& node, const std::string& error) {
    note(node.name() + ": ended with an error: " + error);
    for (Process* const process : processes()) {
      if (process->node() == &node) {
        // Not within the callback of the node that ends.
        world_.after(0.0, nullptr, [this, process, number = node.number()] {
          if (!process->runs() || process->node()->number() != number) return;
          process->fail();
          respawn(*process);
        });
      }
    }
    if (++errors_ > 1000) throw Failure("a node ends with an error again and again: " + error);
  }

  std::vector<Process*> processes() {
    std::vector<Process*> all;
    for (const auto& process : followers_) all.push_back(process.get());
    for (const auto& process : launched_) all.push_back(process.get());
    return all;
  }

  void respawn(Process& process) {
    const bool outlives = kept_ && process.program() == Process::Program::follower;
    process.start_again([this, outlives, launch = token_] { return outlives || (is_up_ && launch == token_); });
  }

  void launch() {
    ++launches_;
    settings_ = random_settings(random_);
    if (kept_) settings_.erase("external");
    const std::string number = std::to_string(launches_);
    const bool records = settings_.erase("record") > 0;
    settings_["output"] = "out/" + number;
    if (records) settings_["record"] = "out/" + number + ".bag";
    for (int attempt = 0; !launch_once(attempt); ++attempt) {
      settings_["resume"] = "true";
      if (records) settings_["record"] = "out/" + number + "_" + std::to_string(attempt) + ".bag";
    }
    const bool whole = configuration_->run.first_realization == 0 && !configuration_->run.record.empty();
    const std::string problem = problem_of(*configuration_, whole);
    if (!problem.empty()) throw Failure(problem);
  }

  /// Returns whether the run is complete; else it is to be resumed.
  bool launch_once(int attempt) {
    settings_["launch_id"] = formatted("launch_%d_%d", launches_, attempt);
    configuration_ = simulation::launched(settings_);
    world_.parameters[std::string(kNamespace) + "/configuration"] = to_json(*configuration_).dump();
    note("launch " + settings_["launch_id"] + ": " + fs::path(settings_["model"]).filename().string() +
         formatted(", %zu followers, %lld steps, %llu realizations from %llu, batches of %llu",
                   configuration_->run.followers, static_cast<long long>(configuration_->run.steps),
                   static_cast<unsigned long long>(configuration_->run.realizations),
                   static_cast<unsigned long long>(configuration_->run.first_realization),
                   static_cast<unsigned long long>(configuration_->run.batch)) +
         (configuration_->run.record.empty() ? "" : ", recorded") + (kept_ ? ", kept followers" : ""));
    ++token_;
    is_up_ = true;
    is_interrupted_ = false;
    const auto add = [this](Process::Program program, std::uint32_t index = 0) {
      launched_.push_back(std::make_unique<Process>(world_, machine_, program, index));
    };
    add(Process::Program::leader);
    add(Process::Program::channel);
    add(Process::Program::monitor);
    for (std::uint32_t i = 1; !kept_ && i <= configuration_->run.followers; ++i) add(Process::Program::follower, i);
    for (const auto& process : launched_) {
      world_.after(world_.uniform(0.05, 0.6), nullptr, [this, launch = token_, each = process.get()] {
        if (is_up_ && launch == token_ && !each->runs()) each->start();
      });
    }
    observer_.emplace(world_, *configuration_);
    last_fault_ = world_.now();
    schedule_fault();
    const auto done = [this] { return is_interrupted_ || observer_->complete(); };
    while (!world_.run_until(done, last_fault_ + kPatience)) {
      if (world_.now() < last_fault_ + kPatience) continue;
      outcome_.hung = true;
      throw Failure("the run has not ended " + formatted("%.0f s", kPatience) + " after the last fault");
    }
    const bool complete = observer_ && observer_->complete();
    end_launch(false);
    return complete;
  }

  void end_launch(bool killed) {
    is_up_ = false;
    Machine::limit_files(0);
    tampering_.reset();
    for (const auto& process : launched_) {
      if (!process->runs()) continue;
      if (killed)
        process->kill();
      else
        process->stop();
    }
    // Events of this launch refer to its processes.
    ended_.insert(ended_.end(), std::make_move_iterator(launched_.begin()), std::make_move_iterator(launched_.end()));
    launched_.clear();
    observer_.reset();
    stray_.clear();
    stranger_.reset();
  }

  /// A fault that is due between two launches waits for the next one.
  void schedule_fault() {
    if (next_fault_ == plan_.faults.size()) return;
    world_.after(std::max(due_ - world_.now(), 0.0), nullptr, [this, launch = token_] {
      if (!is_up_ || is_interrupted_ || launch != token_) return;
      last_fault_ = world_.now();
      inflict(plan_.faults[next_fault_++]);
      if (next_fault_ < plan_.faults.size()) due_ = world_.now() + plan_.faults[next_fault_].wait;
      schedule_fault();
    });
  }

  void inflict(const Fault& fault) {
    note("FAULT " + to_string(fault));
    const std::vector<Process*> all = processes();
    Process& process = *all[fault.which % all.size()];
    switch (fault.kind) {
      case FaultKind::kill:
      case FaultKind::stop:
        if (!process.runs()) return;
        note(process.name());
        if (fault.kind == FaultKind::kill)
          process.kill();
        else
          process.stop();
        return respawn(process);
      case FaultKind::pause:
        if (!process.runs()) return;
        note(process.name());
        return world_.pause(*process.node(), 6.0 * fault.extent * fault.extent);
      case FaultKind::cut:
      case FaultKind::slow:
        return disturb_connection(fault);
      case FaultKind::full_disk:
        return fill_disk(fault);
      case FaultKind::set_clock:
        return machine_.set_clock(2e5 * (fault.extent - 0.5));
      case FaultKind::stray:
        return publish_stray(fault);
      case FaultKind::tamper:
        tampering_ = fault;
        return;
      case FaultKind::interrupt:
      case FaultKind::power:
        return interrupt(fault);
    }
  }

  void disturb_connection(const Fault& fault) {
    const auto connections = world_.all_connections();
    if (connections.empty()) return;
    const auto& connection = connections[fault.which % connections.size()];
    note(connection->sent.lock()->topic + " to " + connection->received.lock()->node->name());
    if (fault.kind == FaultKind::cut) return world_.cut(connection);
    connection->slow_until = world_.now() + 3.0 * fault.extent;
  }

  void fill_disk(const Fault& fault) {
    Machine::limit_files(1 + static_cast<std::size_t>(20000.0 * fault.extent));
    world_.after(3.0 * fault.extent, nullptr, [] { Machine::limit_files(0); });
  }

  void interrupt(const Fault& fault) {
    is_interrupted_ = true;
    if (fault.kind == FaultKind::interrupt) return;
    end_launch(true);
    for (const auto& follower : followers_) {
      if (follower->runs()) follower->kill();
      respawn(*follower);
    }
    machine_.lose_power("out", [this] { return world_.uniform(0.0, 1.0); });
  }

  void publish_stray(const Fault& fault) {
    if (!stranger_) stranger_ = std::make_unique<Node>(world_, "/stranger");
    const auto vehicle = static_cast<std::uint32_t>(fault.which % (configuration_->run.followers + 1));
    const bool received = fault.extent < 0.5 && vehicle > 0;
    world_.as(stranger_.get(), [&] {
      ros::NodeHandle platoon(kNamespace);
      const std::string topic = received ? predecessor_position_topic(vehicle) : position_topic(vehicle);
      ros::Publisher& publisher = stray_[topic];
      if (!publisher) publisher = platoon.advertise<stochastic_platoon::Position>(topic, 0);
      stochastic_platoon::Position message;
      message.run = 1 + fault.which;
      message.step = -1;
      message.position.assign(configuration_->run.batch, 0.0);
      publisher.publish(message);
    });
  }

  std::optional<ros::SerializedMessage> tampered(const SentTopic& topic, const ros::SerializedMessage& message) {
    if (!tampering_ || configuration_->run.external.empty()) return message;
    const auto external = static_cast<std::size_t>(configuration_->run.external.front());
    if (topic.topic != std::string(kNamespace) + "/" + position_topic(external) || !message.message) return message;
    return simulation::tampered(message, std::exchange(tampering_, std::nullopt)->which);
  }

  Plan plan_;
  std::mt19937_64 random_;
  Machine machine_;
  World world_;
  bool kept_;
  double began_ = 0.0, last_fault_ = 0.0, due_ = 0.0;  // [s]; due_: the next fault
  Outcome outcome_;
  std::size_t next_fault_ = 0;
  int launches_ = 0, token_ = 0, errors_ = 0;  // token_: counts the resumed ones, too
  bool is_up_ = false, is_interrupted_ = false;
  std::map<std::string, std::string> settings_;
  std::optional<Configuration> configuration_;
  std::vector<std::unique_ptr<Process>> followers_, launched_, ended_;
  std::optional<Observer> observer_;
  std::unique_ptr<Node> stranger_;
  std::map<std::string, ros::Publisher> stray_;
  std::optional<Fault> tampering_;
};

}  // namespace

Outcome carry_out(const Plan& plan) {
  fs::remove_all("out");
  fs::create_directory("out");
  return Scenario(plan).run();
}

}  // namespace platoon::simulation
