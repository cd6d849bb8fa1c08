#include "stochastic_platoon/run/io/progress_display.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace platoon {

ProgressDisplay::ProgressDisplay(std::uint64_t total, std::string unit, double work_per_unit, std::string work_unit)
    : total_(total),
      unit_(std::move(unit)),
      work_per_unit_(work_per_unit),
      work_unit_(std::move(work_unit)),
      terminal_(isatty(STDOUT_FILENO) == 1) {}

std::string ProgressDisplay::line(std::uint64_t done, double now) const {
  const double share = static_cast<double>(done) / static_cast<double>(total_);
  const double elapsed = now - began_.value_or(now);
  const double rate = elapsed > 0.0 ? static_cast<double>(done - began_at_) / elapsed : 0.0;
  const double left = rate > 0.0 ? static_cast<double>(total_ - done) / rate : 0.0;
  std::string bar(30, '.');
  for (std::size_t i = 0; i < static_cast<std::size_t>(30.0 * share); ++i) bar[i] = '#';
  char text[200];
  std::snprintf(text, sizeof text, "[%s] %3.0f %%  %llu/%llu %s  %.3g %s/s  %.0f s left", bar.c_str(), 100.0 * share,
                static_cast<unsigned long long>(done), static_cast<unsigned long long>(total_), unit_.c_str(),
                rate * work_per_unit_, work_unit_.c_str(), left);
  return note_.empty() ? text : text + ("  " + note_);
}

void ProgressDisplay::draw(const std::string& text) {
  std::printf(terminal_ ? "\r%s \033[K" : "%s\n", text.c_str());
  std::fflush(stdout);
  drawn_ = true;
}

void ProgressDisplay::prepare(const std::string& what, double now) {
  if (!last_preparation_) last_preparation_ = now;
  if (now - *last_preparation_ < (terminal_ ? 0.1 : 10.0)) return;
  last_preparation_ = now;
  draw(what);
}

void ProgressDisplay::update(std::uint64_t done, double now) {
  if (!began_) {
    began_ = last_ = now;
    began_at_ = done;
    last_tenth_ = 10 * done / total_;
  }
  const std::uint64_t tenth = 10 * done / total_;
  const bool due = terminal_ ? now - last_ >= 0.1 || done == total_ : tenth > last_tenth_ || now - last_ >= 10.0;
  if (!due) return;
  last_ = now;
  last_tenth_ = tenth;
  draw(line(done, now));
}

void ProgressDisplay::finish() {
  if (terminal_ && drawn_) std::printf("\n");
  std::fflush(stdout);
  drawn_ = false;
}

}  // namespace platoon
