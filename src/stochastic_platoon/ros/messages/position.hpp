#pragma once

#include <ros/duration.h>
#include <ros/time.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"
#include "stochastic_platoon/run/delivery/signal_assembly.hpp"

namespace platoon {

/// The message's identifier within its run: attempt, first realization and step.
MessageId id_of(const stochastic_platoon::Position& message);

/// The message's identifier, number of positions, and whether all are finite; reads all positions.
MessageDescriptor descriptor_of(const stochastic_platoon::Position& message);

/// Sets the message's run and identifier.
void set_id(std::uint64_t run, const MessageId& id, stochastic_platoon::Position& message);

/// The message's array, shared, not copied.
Positions positions_of(const stochastic_platoon::Position::ConstPtr& message);

/// T_s [s] in platoon time, rounded to whole nanoseconds.
ros::Duration platoon_period(double sample_period);

/// Platoon time from nanoseconds; saturates at TIME_MAX.
ros::Time platoon_time(std::uint64_t nanoseconds);

/// `stamp` plus `period` (above 0), for any stamp of any message; saturates at TIME_MAX.
ros::Time later(const ros::Time& stamp, const ros::Duration& period);

bool all_finite(const std::vector<double>& values);

}  // namespace platoon
