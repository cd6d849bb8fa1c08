#pragma once

#include <string>
#include <vector>

namespace platoon {

/// The results in a folder, judged.
struct ResultCheck {
  std::vector<std::string> problems;  ///< one sentence each; empty if the results pass
  std::string passed;                 ///< the result in one line if there are no problems
};

/// Checks that the run in a folder is complete, that no file has changed since it was written, and that its figures
/// agree:
///
/// - measurement and theory, by the scores of the summary and, for normal errors, by those of the table, computed anew;
/// - the theory of all tables and of the summary with the theory of the recorded model, computed anew;
/// - places and counts of the rows with the run's followers, steps and realizations;
/// - the figures of the theory with each other, see contradictions();
/// - the verdict with the measured growth, see measured_growth().
///
/// Throws std::exception if there are no results that this version can read, also for a run without a summary: then
/// with the extent of its checkpoint.
ResultCheck check_results(const std::string& folder);

}  // namespace platoon
