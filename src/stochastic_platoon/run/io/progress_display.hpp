#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace platoon {

/// Progress of a long job on standard output: on a terminal a bar with rate and remaining time that redraws itself,
/// otherwise plain lines, one per tenth of the job or every ten seconds.
class ProgressDisplay {
public:
  /// `unit` names the counted items; each of them is `work_per_unit` units of work ("vehicle-steps").
  ProgressDisplay(std::uint64_t total, std::string unit, double work_per_unit, std::string work_unit);

  /// `now` in seconds of any steady clock. Draws at most ten times a second.
  void update(std::uint64_t done, double now);

  /// Shows `what` before anything can be counted. Without a terminal: one line every ten seconds, the first after ten
  /// seconds.
  void prepare(const std::string& what, double now);

  /// Sets the text at the end of the line, such as the state of the recorder.
  void set_note(const std::string& note) { note_ = note; }

  /// Ends the bar's line, so that other text can follow.
  void finish();

private:
  std::string line(std::uint64_t done, double now) const;
  void draw(const std::string& text);

  std::uint64_t total_;
  std::string unit_;
  double work_per_unit_;
  std::string work_unit_;
  std::string note_;
  bool terminal_;
  bool drawn_ = false;
  std::optional<double> began_;             ///< [s] of the first update
  std::uint64_t began_at_ = 0;              ///< items done by then
  double last_ = 0.0;                       ///< [s] of the latest drawing
  std::optional<double> last_preparation_;  ///< [s] of the latest line of prepare()
  std::uint64_t last_tenth_ = 0;
};

}  // namespace platoon
