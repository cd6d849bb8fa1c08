#include "stochastic_platoon/ros/observation/diagnostics.hpp"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <diagnostic_msgs/DiagnosticStatus.h>

#include <algorithm>

#include "stochastic_platoon/ros/transport/kept_topics.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

namespace {
constexpr int kFirst = 3;  // [s] after the start
}

void VitalSigns::operator()(DiagnosticStatusWrapper& status) {
  std::int64_t first = INT64_MAX, last = kNothingYet;
  std::uint32_t attempt = 0;
  std::uint64_t messages = 0, faults = 0;
  std::array<std::uint64_t, kDropReasons> dropped{};
  for (const MessageCounter* source : sources_) {
    first = std::min(first, source->step());
    last = std::max(last, source->step());
    attempt = std::max(attempt, source->attempt());
    messages += source->taken();
    for (std::size_t v = 0; v < kDropReasons; ++v) dropped[v] += source->dropped(static_cast<DropReason>(v));
    faults += source->faults();
  }
  const double present = now();
  const double seconds = present - last_time_;
  const double rate = static_cast<double>(messages - std::min(messages, last_messages_)) / seconds;
  const bool dropping = faults > last_faults_;
  if (dropping) {
    status.summary(DiagnosticStatus::WARN, "drops messages");
  } else {
    status.summary(DiagnosticStatus::OK, messages == 0 ? "waits" : "takes part");
  }
  status.add("step", last);
  if (sources_.size() > 1) status.add("step of the furthest behind", first);
  if (last_time_ > 0.0) status.add("steps per second", rate / static_cast<double>(sources_.size()));
  status.add("attempts", attempt);
  status.add("messages", messages);
  for (std::size_t v = 0; v < kDropReasons; ++v) {
    const auto drop = static_cast<DropReason>(v);
    if (drop != DropReason::none) status.add(std::string("dropped: ") + to_string(drop), dropped[v]);
  }
  last_time_ = present;
  last_messages_ = messages;
  last_faults_ = faults;
}

Diagnostics::Diagnostics(const ros::NodeHandle& platoon) : platoon_(platoon) {
  timer_ = platoon_.createSteadyTimer(ros::WallDuration(1.0), [this](const auto&) { update(); });
}

void Diagnostics::add(const std::string& name, Fill fill) {
  fills_.emplace_back(name, std::move(fill));
}

void Diagnostics::update() {
  if (++seconds_ < kFirst) return;
  if (!updater_) {
    advertise_kept<diagnostic_msgs::DiagnosticArray>(platoon_, "/diagnostics", 1);
    updater_ = std::make_unique<diagnostic_updater::Updater>(platoon_);
    updater_->setHardwareID("none");
    for (const auto& entry : fills_) updater_->add(entry.first, entry.second);
  }
  updater_->force_update();
}

}  // namespace platoon
