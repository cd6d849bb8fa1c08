#include "stochastic_platoon/run/io/progress_display.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "unit/messages.hpp"

namespace platoon {
namespace {

// The output of a job of 100 realizations if standard output is not a terminal.
template <typename Job>
std::string printed(const Job& job) {
  testing::internal::CaptureStdout();
  ProgressDisplay display(100, "realizations", 50.0, "vehicle-steps");
  job(display);
  display.finish();
  return testing::internal::GetCapturedStdout();
}

// The same if it is a terminal, which writes "\r\n" for each "\n".
template <typename Job>
std::string drawn(const Job& job) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY), kept = ::dup(STDOUT_FILENO);
  EXPECT_TRUE(terminal >= 0 && ::grantpt(terminal) == 0 && ::unlockpt(terminal) == 0);
  const int output = ::open(::ptsname(terminal), O_RDWR | O_NOCTTY);
  std::fflush(stdout);
  ::dup2(output, STDOUT_FILENO);
  ProgressDisplay display(100, "realizations", 50.0, "vehicle-steps");
  job(display);
  display.finish();
  ::dup2(kept, STDOUT_FILENO);
  std::string text;  // comes in parts; finish() ends it with the only line feed
  for (char next = 0; next != '\n' && ::read(terminal, &next, 1) == 1;) text += next;
  for (const int descriptor : {output, terminal, kept}) ::close(descriptor);
  return text;
}

std::ptrdiff_t lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

TEST(ProgressDisplay, PrintsALinePerTenthWithoutATerminal) {
  const std::string text = printed([](ProgressDisplay& display) {
    for (std::uint64_t done = 0; done <= 100; ++done) display.update(done, 0.01 * static_cast<double>(done));
  });
  EXPECT_EQ(lines(text), 10);
  EXPECT_FALSE(contains(text, "\r"));
  EXPECT_TRUE(contains(text, "100 %  100/100 realizations"));
}

TEST(ProgressDisplay, RedrawsTheBarTenTimesASecondAndAtTheEndOnATerminal) {
  const std::string text = drawn([](ProgressDisplay& display) {
    display.prepare("waiting", 0.0);
    for (int tenth = 0; tenth <= 3; ++tenth) display.prepare("waiting", 0.125 * tenth);
    for (std::uint64_t done = 0; done <= 100; ++done) display.update(done, 1.0 + 0.0078125 * static_cast<double>(done));
  });
  const auto redrawn = std::count(text.begin(), text.end(), '\r') - lines(text);
  EXPECT_EQ(lines(text), 1);
  EXPECT_EQ(redrawn, 3 + 7 + 1) << "three of the preparation, seven after 13 realizations each, and the last";
  EXPECT_TRUE(contains(text, "] 100 %  100/100 realizations"));
}

TEST(ProgressDisplay, PrintsALineAfterTenSecondsWithoutATenth) {
  EXPECT_EQ(lines(printed([](ProgressDisplay& display) {
              for (int second = 0; second <= 25; ++second) display.update(1, second);
            })),
            2);
}

TEST(ProgressDisplay, ShowsRateAndTimeLeft) {
  const std::string text = printed([](ProgressDisplay& display) {
    display.update(0, 100.0);
    display.update(20, 104.0);
  });
  EXPECT_EQ(text, "[######........................]  20 %  20/100 realizations  250 vehicle-steps/s  16 s left\n");
}

TEST(ProgressDisplay, MeasuresTheRateOfAResumedJobFromItsStart) {
  const std::string text = printed([](ProgressDisplay& display) {
    display.update(60, 100.0);
    display.update(80, 110.0);
  });
  EXPECT_TRUE(contains(text, "80/100 realizations  100 vehicle-steps/s  10 s left"));
}

TEST(ProgressDisplay, ShowsALongPreparation) {
  const std::string text = printed([](ProgressDisplay& display) {
    for (int second = 0; second <= 15; ++second)
      display.prepare("waiting for " + std::to_string(20 - second) + " vehicles", second);
  });
  EXPECT_EQ(text, "waiting for 10 vehicles\n");
}

TEST(ProgressDisplay, EndsItsLineWithTheNote) {
  const std::string text = printed([](ProgressDisplay& display) {
    display.set_note("bag 12 MB");
    display.update(0, 0.0);
    display.update(50, 1.0);
  });
  EXPECT_TRUE(contains(text, "s left  bag 12 MB\n"));
}

}  // namespace
}  // namespace platoon
