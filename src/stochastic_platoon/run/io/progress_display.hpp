#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace platoon {

/// Progress of a long job on standard output: a bar with rate and time left that redraws itself on a
/// terminal; plain lines, one per tenth of the job or ten seconds, where it is no terminal.
class ProgressDisplay {
public:
  /// `unit` names what is counted; `per_unit` units of work ("vehicle-steps") stand behind each.
  ProgressDisplay(std::uint64_t total, std::string unit, double work_per_unit, std::string work_unit);

  /// `now` in seconds of any steady clock. Draws at most ten times a second.
  void update(std::uint64_t done, double now);

  /// What goes on before anything can be counted. Where it is no terminal, a line every ten seconds, the first
  /// after ten.
  void prepare(const std::string& what, double now);

  /// What stands at the end of the line: the state of others who work beside this job.
  void set_note(const std::string& note) { note_ = note; }

  /// Ends the line of the bar, so that other text can follow.
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
  std::optional<double> began_;             ///< [s] the first update
  std::uint64_t began_at_ = 0;              ///< done then
  double last_ = 0.0;                       ///< [s] when it was drawn
  std::optional<double> last_preparation_;  ///< [s] the same
  std::uint64_t last_tenth_ = 0;
};

}  // namespace platoon
