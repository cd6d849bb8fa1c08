#include "stochastic_platoon/ros/hosting/work_queue.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <functional>
#include <mutex>
#include <numeric>
#include <thread>

#include "stochastic_platoon/ros/transport/spin_lock.hpp"

namespace platoon {
namespace {

class Callback : public ros::CallbackInterface {
public:
  explicit Callback(std::function<CallResult()> call) : call_(std::move(call)) {}
  CallResult call() override { return call_(); }

private:
  std::function<CallResult()> call_;
};

ros::CallbackInterfacePtr calling(const std::function<void()>& action) {
  return boost::make_shared<Callback>([action] {
    action();
    return ros::CallbackInterface::Success;
  });
}

TEST(WorkQueue, RunsCallbacksInTheOrderOfArrival) {
  WorkQueue queue, at_once;
  std::vector<int> order;
  for (int j = 0; j < 5; ++j) queue.addCallback(calling([&order, j] { order.push_back(j); }), 1);
  queue.run(at_once, [&order] { return order.size() < 5; });
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(WorkQueue, DrainsTheUrgentQueueAfterEachCallback) {
  WorkQueue queue, at_once;
  std::string order;
  for (const char name : {'a', 'b', 'c'}) {
    queue.addCallback(calling([&, name] {
                        order += name;
                        at_once.addCallback(calling([&order] { order += '!'; }), 1);
                      }),
                      1);
  }
  queue.run(at_once, [&order] { return order.size() < 6; });
  EXPECT_EQ(order, "a!b!c!");
}

TEST(WorkQueue, RetriesACallbackThatRequestsIt) {
  WorkQueue queue, at_once;
  int calls = 0;
  queue.addCallback(boost::make_shared<Callback>([&calls] {
                      return ++calls < 3 ? ros::CallbackInterface::TryAgain : ros::CallbackInterface::Success;
                    }),
                    1);
  queue.run(at_once, [&calls] { return calls < 3; });
  EXPECT_EQ(calls, 3);
}

TEST(WorkQueue, DropsTheCallbacksOfARemovedOwner) {
  WorkQueue queue, at_once;
  std::vector<std::uint64_t> called;
  for (const std::uint64_t owner : {1, 2, 1, 2}) {
    queue.addCallback(calling([&called, owner] { called.push_back(owner); }), owner);
  }
  queue.removeByID(1);
  queue.run(at_once, [&called] { return called.size() < 2; });
  EXPECT_EQ(called, (std::vector<std::uint64_t>{2, 2}));
}

TEST(WorkQueue, LosesNoCallbackThatOtherThreadsAdd) {
  constexpr int kEach = 20000;
  WorkQueue queue, at_once;
  std::atomic<int> called{0};
  std::thread server([&] { queue.run(at_once, [&called] { return called < 2 * kEach; }); });
  const auto add = [&](bool in_bursts) {
    for (int j = 0; j < kEach; ++j) {
      queue.addCallback(calling([&called] { ++called; }), 1);
      if (in_bursts && j % 2000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  std::thread one([&] { add(true); }), other([&] { add(false); });
  one.join();
  other.join();
  server.join();
  EXPECT_EQ(called, 2 * kEach);
}

TEST(SpinLock, AdmitsOneThreadAtATime) {
  SpinLock lock;
  std::uint64_t count = 0;
  const auto work = [&] {
    for (int j = 0; j < 100000; ++j) {
      const std::lock_guard<SpinLock> locked(lock);
      ++count;
    }
  };
  std::thread one(work), other(work);
  one.join();
  other.join();
  EXPECT_EQ(count, 200000u);
}

}  // namespace
}  // namespace platoon
