#include "stochastic_platoon/ros/hosting/receiving_thread.hpp"

namespace platoon {

void ReceivingThread::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) {
  const std::lock_guard<std::mutex> one_at_a_time(mutex_);
  callback->call();
}

}  // namespace platoon
