#include "simulation/roslaunch.hpp"

#include <algorithm>
#include <iterator>

namespace platoon::simulation {

Roslaunch::~Roslaunch() {
  end(true);
  for (const auto& follower : kept_) {
    if (follower->runs()) follower->kill();
  }
}

void Roslaunch::keep(std::uint32_t followers) {
  for (std::uint32_t i = 1; i <= followers; ++i)
    kept_.push_back(std::make_unique<Process>(world_, machine_, Process::Program::follower, i, true));
  for (const auto& follower : kept_) follower->start();
}

std::vector<Part> Roslaunch::nodes_of(const RunOptions& run) const {
  const bool in_one = run.hosting == Hosting::one_process;
  using Program = Process::Program;
  std::vector<Part> parts = in_one ? std::vector<Part>{{Program::platoon}}
                                   : std::vector<Part>{{Program::leader}, {Program::channel}, {Program::monitor}};
  for (std::uint32_t i = 1; kept_.empty() && i <= run.followers; ++i) {
    if (!in_one || run.is_external(i)) parts.push_back({Program::follower, i});
  }
  return parts;
}

void Roslaunch::launch(const std::vector<Part>& parts) {
  ++number_;
  is_up_ = true;
  for (const Part& part : parts)
    launched_.push_back(std::make_unique<Process>(world_, machine_, part.program, part.index, false, part.bags));
  for (const auto& process : launched_) {
    world_.after(world_.uniform(0.05, 0.6), nullptr, [this, launch = number_, each = process.get()] {
      if (is_up_ && launch == number_ && !each->runs()) each->start();
    });
  }
}

void Roslaunch::end(bool killed) {
  is_up_ = false;
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
}

void Roslaunch::lose_power() {
  end(true);
  for (const auto& follower : kept_) {
    if (follower->runs()) follower->kill();
    respawn(*follower);
  }
}

std::vector<Process*> Roslaunch::processes() const {
  std::vector<Process*> all;
  for (const auto& process : kept_) all.push_back(process.get());
  for (const auto& process : launched_) all.push_back(process.get());
  return all;
}

bool Roslaunch::is_replay() const {
  return std::any_of(launched_.begin(), launched_.end(), [](const auto& process) { return process->is_required(); });
}

Process* Roslaunch::process_of(const Node& node) const {
  const std::vector<Process*> all = processes();
  const auto found =
      std::find_if(all.begin(), all.end(), [&node](const Process* process) { return process->node() == &node; });
  return found != all.end() ? *found : nullptr;
}

bool Roslaunch::is_required(const Node& node) const {
  const Process* const process = process_of(node);
  return process != nullptr && process->is_required();
}

// Not within the callback of the node that ends.
void Roslaunch::ended(const Node& node) {
  Process* const process = process_of(node);
  if (process == nullptr) return;
  world_.after(0.0, nullptr, [this, process, number = node.number()] {
    if (!process->runs() || process->node()->number() != number) return;
    process->fail();
    respawn(*process);
  });
}

void Roslaunch::respawn(Process& process) {
  const bool outlives = !kept_.empty() && process.program() == Process::Program::follower;
  process.start_again([this, outlives, launch = number_] { return outlives || (is_up_ && launch == number_); });
}

}  // namespace platoon::simulation
