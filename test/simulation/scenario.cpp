#include "simulation/scenario.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <utility>

#include "simulation/history.hpp"
#include "simulation/launches.hpp"
#include "simulation/outsiders.hpp"
#include "simulation/roslaunch.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon::simulation {

namespace {

constexpr double kPatience = 300.0;          // [s] from the last fault to the end of a run
constexpr double kCalm = 1.0;                // [s] from the last fault, as reports of a killed monitor arrive later
constexpr std::uint32_t kMostFollowers = 4;  // of any launch

class Scenario {
public:
  explicit Scenario(const Plan& plan)
      : plan_(plan), random_(plan.seed * 2 + 1), world_(plan.seed), roslaunch_(world_, machine_), history_(world_) {
    last_fault_ = world_.now();
    due_ = last_fault_ + (plan_.faults.empty() ? 0.0 : plan_.faults.front().wait);
    world_.log = [this](const std::string& line) { history_.log(line); };
    world_.died = [this](Node& node, const std::string& error) { died(node, error); };
    world_.tamper = [this](const SentTopic& topic, const ros::SerializedMessage& message) {
      return tampered(topic, message);
    };
    if (random_() % 2 == 0) roslaunch_.keep(kMostFollowers);
  }

  ~Scenario() { end_launch(true); }

  Outcome run() {
    try {
      while (next_fault_ < plan_.faults.size() || launches_ == 0) launch();
    } catch (const std::exception& error) {
      outcome_.wrong =
          (dynamic_cast<const Failure*>(&error) != nullptr ? "" : "exception: ") + std::string(error.what());
    }
    outcome_.history = history_.lines();
    return std::move(outcome_);
  }

private:
  void died(Node& node, const std::string& error) {
    history_.note(node.name() + ": ended with an error: " + error);
    if (roslaunch_.is_required(node)) throw Failure("a replay ended: " + error);
    roslaunch_.ended(node);
    if (++errors_ > 1000) throw Failure("a node ends with an error again and again: " + error);
  }

  void launch() {
    ++launches_;
    const bool is_endless = random_() % 6 == 0;
    const std::string name = "out/" + std::to_string(launches_);
    settings_ = random_settings(random_, is_endless, name);
    if (roslaunch_.keeps_followers()) settings_.erase("external");
    if (is_endless) return launch_endless();
    for (int attempt = 0; !launch_once(attempt); ++attempt) {
      settings_["resume"] = "true";
      if (settings_.count("record") > 0) settings_["record"] = name + "_" + std::to_string(attempt) + ".bag";
    }
    const bool whole = configuration_->run.first_realization == 0 && !configuration_->run.record.empty();
    require_none(problem_of(*configuration_, whole));
    if (whole) replay(recorded_files(configuration_->run));
  }

  /// Returns whether the run is complete; else it is to be resumed.
  bool launch_once(int attempt) {
    settings_["launch_id"] = formatted("launch_%d_%d", launches_, attempt);
    configuration_ = simulation::launched(settings_);
    return carry_out(roslaunch_.nodes_of(configuration_->run), [this] { return observer_->complete(); });
  }

  void launch_endless() {
    settings_["launch_id"] = formatted("launch_%d", launches_);
    configuration_ = simulation::launched(settings_);
    runs_ = {*configuration_};
    run_ = run_identity(*configuration_);
    faults_left_ = 2 + random_() % 15;
    const bool complete = carry_out(roslaunch_.nodes_of(configuration_->run), [this] {
      return faults_are_over() && observer_->has(run_, kEndlessSteps, last_fault_ + kCalm);
    });
    faults_left_.reset();
    if (complete && !std::filesystem::exists(runs_.back().run.output + "/statistics.csv"))
      throw Failure(runs_.back().run.output + " has no results");
    for (const Configuration& run : runs_) {
      if (changes_ && !run.run.record.empty()) require_none(problem_of_endless(run, lost_power_));
    }
  }

  /// Into a monitor, to live followers behind the recorded leader, or of the inputs of one live follower.
  void replay(const std::vector<std::string>& bags) {
    const std::string output = "out/" + std::to_string(launches_) + "_replayed";
    const auto kind = random_() % 4;
    if (kind == 3) return replay_to_follower(bags, output);
    configuration_ = kind == 0 ? behind_recorded_leader(random_, bags, output) : replayed(bags, output);
    const std::vector<Part> player{{Process::Program::player, 0, bags}, {Process::Program::monitor}};
    const bool complete = carry_out(kind == 0 ? roslaunch_.nodes_of(configuration_->run) : player,
                                    [this] { return observer_->complete(); });
    if (complete) require_none(problem_of(*configuration_, false));
  }

  void replay_to_follower(const std::vector<std::string>& bags, const std::string& output) {
    configuration_ = replayed(bags, output);
    const auto index = static_cast<std::uint32_t>(1 + random_() % configuration_->run.followers);
    std::vector<Part> parts{{Process::Program::vehicle_replay, index, bags}};
    if (!roslaunch_.keeps_followers()) parts.push_back({Process::Program::follower, index});
    carry_out(parts, [this] {
      const VehicleReplay* const replay = roslaunch_.launched().front()->replay();
      if (replay == nullptr || !replay->done()) return false;
      if (!replay->equal()) throw Failure(replay->verdict());
      return true;
    });
  }

  /// Launches the nodes and waits until the launch is done, which is returned, or interrupted.
  bool carry_out(const std::vector<Part>& parts, const std::function<bool()>& is_done) {
    world_.parameters[std::string(kNamespace) + "/configuration"] = to_json(*configuration_).dump();
    history_.note(description(*configuration_) + ", " + std::filesystem::path(settings_["model"]).filename().string() +
                  (roslaunch_.keeps_followers() ? ", kept followers" : ""));
    changes_ = random_() % 2 == 0;
    is_interrupted_ = lost_power_ = false;
    roslaunch_.launch(parts);
    observer_.emplace(world_, *configuration_);
    operator_.emplace(world_, [this](const std::string& service, const std_srvs::TriggerResponse& response) {
      answered(service, response);
    });
    last_fault_ = world_.now();
    schedule_fault();
    const auto done = [&] { return is_interrupted_ || is_done(); };
    while (!world_.run_until(done, last_fault_ + kPatience)) {
      if (world_.now() < last_fault_ + kPatience) continue;
      outcome_.hung = true;
      throw Failure("the run has not ended " + formatted("%.0f s", kPatience) + " after the last fault");
    }
    const bool complete = !is_interrupted_ || (observer_ && is_done());
    end_launch(false);
    return complete;
  }

  void end_launch(bool killed) {
    Machine::limit_files(0);
    tampering_.reset();
    roslaunch_.end(killed);
    observer_.reset();
    operator_.reset();
    stranger_.reset();
  }

  bool faults_are_over() const { return next_fault_ == plan_.faults.size() || faults_left_ == 0; }

  /// A fault that is due between two launches waits for the next one.
  void schedule_fault() {
    if (faults_are_over()) return;
    world_.after(std::max(due_ - world_.now(), 0.0), nullptr, [this, launch = roslaunch_.number()] {
      if (!roslaunch_.is_up() || is_interrupted_ || launch != roslaunch_.number()) return;
      last_fault_ = world_.now();
      if (faults_left_) --*faults_left_;
      inflict(plan_.faults[next_fault_++]);
      if (next_fault_ < plan_.faults.size()) due_ = world_.now() + plan_.faults[next_fault_].wait;
      schedule_fault();
    });
  }

  void inflict(const Fault& fault) {
    history_.note("FAULT " + to_string(fault));
    if (faults_left_ && fault.which / 7 % 4 == 0) return order(fault);
    const std::vector<Process*> all = roslaunch_.processes();
    Process& process = *all[fault.which % all.size()];
    switch (fault.kind) {
      case FaultKind::kill:
        if (fault.which / 11 % 16 == 0) {
          history_.note("all of the launch");
          for (const auto& each : roslaunch_.launched()) end(*each, true);
          return;
        }
        return end(process, true);
      case FaultKind::stop:
        return end(process, false);
      case FaultKind::pause:
        if (!process.runs()) return;
        history_.note(process.name());
        return world_.pause(*process.node(), 6.0 * fault.extent * fault.extent);
      case FaultKind::cut:
      case FaultKind::slow:
        return history_.note(disturb_connection(world_, fault));
      case FaultKind::full_disk:
        return fill_disk(world_, fault);
      case FaultKind::set_clock:
        return machine_.set_clock(2e5 * (fault.extent - 0.5));
      case FaultKind::stray:
        if (!stranger_) stranger_.emplace(world_);
        return stranger_->publish(*configuration_, fault.which, fault.extent);
      case FaultKind::tamper:
        tampering_ = fault;
        return;
      case FaultKind::order:
        return order(fault);
      case FaultKind::interrupt:
      case FaultKind::power:
        return interrupt(fault);
    }
  }

  void end(Process& process, bool killed) {
    if (!process.runs()) return;
    history_.note(process.name());
    if (killed)
      process.kill();
    else
      process.stop();
    if (process.is_required())
      is_interrupted_ = true;
    else
      roslaunch_.respawn(process);
  }

  void order(const Fault& fault) {
    if (changes_) return operator_->change_run(fault.which, fault.extent);
    history_.note(operator_->drive(fault.which, fault.extent));
  }

  void answered(const std::string& service, const std_srvs::TriggerResponse& response) {
    history_.note(service + (response.success ? ": " : ": rejected: ") + response.message);
    if (!response.success) return;
    if (configuration_->run.averaging() == Averaging::over_realizations)
      return history_.fail("a run over realizations has taken an order: " + response.message);
    if (service != kChangeRunService) return;
    const std::string text = world_.parameters[std::string(kNamespace) + "/configuration"];
    const Configuration next = parse_configuration(text);
    if (next.run.number == runs_.back().run.number)
      return history_.fail("an answered order is not in the configuration");
    runs_.push_back(next);
    run_ = run_identity(next);
    if (!world_.happens(0.3)) return;
    world_.after(world_.uniform(0.0, 0.05), nullptr, [this] {
      for (Process* const process : roslaunch_.processes()) {
        if (process->has_monitor()) end(*process, true);
      }
    });
  }

  void interrupt(const Fault& fault) {
    is_interrupted_ = true;
    lost_power_ = fault.kind == FaultKind::power;
    if (fault.kind == FaultKind::interrupt) return;
    end_launch(true);
    roslaunch_.lose_power();
    machine_.lose_power("out", [this] { return world_.uniform(0.0, 1.0); });
  }

  std::optional<ros::SerializedMessage> tampered(const SentTopic& topic, const ros::SerializedMessage& message) {
    if (!tampering_ || roslaunch_.is_replay() || configuration_->run.external.empty()) return message;
    const auto external = static_cast<std::size_t>(configuration_->run.external.front());
    if (topic.topic != std::string(kNamespace) + "/" + position_topic(external) || !message.message) return message;
    return simulation::tampered(message, std::exchange(tampering_, std::nullopt)->which);
  }

  Plan plan_;
  std::mt19937_64 random_;
  Machine machine_;
  World world_;
  Roslaunch roslaunch_;
  History history_;
  double last_fault_ = 0.0, due_ = 0.0;  // [s]; due_: the next fault
  Outcome outcome_;
  std::size_t next_fault_ = 0;
  int launches_ = 0, errors_ = 0;  // launches_: without the resumed ones and the replays
  bool is_interrupted_ = false, lost_power_ = false;
  std::vector<Configuration> runs_;         ///< of an endless launch, one for each change
  std::uint64_t run_ = 0;                   ///< the identity of the last of them
  bool changes_ = false;                    ///< whether orders change the run; else they are for the leader
  std::optional<std::size_t> faults_left_;  ///< of an endless launch
  std::map<std::string, std::string> settings_;
  std::optional<Configuration> configuration_;
  std::optional<Observer> observer_;
  std::optional<Operator> operator_;
  std::optional<Stranger> stranger_;
  std::optional<Fault> tampering_;
};

}  // namespace

Outcome carry_out(const Plan& plan) {
  std::filesystem::remove_all("out");
  std::filesystem::create_directory("out");
  return Scenario(plan).run();
}

}  // namespace platoon::simulation
