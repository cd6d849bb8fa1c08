#pragma once

#include <ros/duration.h>
#include <ros/time.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"
#include "stochastic_platoon/run/delivery/error_assembly.hpp"

namespace platoon {

/// The message's name within its run.
MessageId id_of(const stochastic_platoon::Position& message);

/// What delivery needs to know of the message: reads all of its positions.
MessageDescriptor descriptor_of(const stochastic_platoon::Position& message);

/// Makes it the message of this name in this run.
void set_id(std::uint64_t run, const MessageId& id, stochastic_platoon::Position& message);

/// The message's array, shared, not copied.
Positions positions_of(const stochastic_platoon::Position::ConstPtr& message);

/// T_s [s] as platoon time counts it: whole nanoseconds.
ros::Duration platoon_period(double sample_period);

/// Platoon time of so many nanoseconds; the last that a stamp can bear for more.
ros::Time platoon_time(std::uint64_t nanoseconds);

/// The stamp and a period above 0 more; at the end of all stamps it stands still. Any stamp of any message will do.
ros::Time later(const ros::Time& stamp, const ros::Duration& period);

/// Whether every value is finite.
bool all_finite(const std::vector<double>& values);

}  // namespace platoon
