#pragma once

#include <string>

#include "paper_platoon.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// A short run of the paper's example: 2 followers, 3 steps, 20 realizations in batches of 8.
inline Configuration paper_run(const std::string& output, double headway = 3.2) {
  RunOptions run{};
  run.followers = 2;
  run.steps = 3;
  run.realizations = 20;
  run.batch = 8;
  run.seed = 1;
  run.hosting = Hosting::processes;
  run.output = output;
  run.launch_id = "this launch";
  run.number = 1;
  run.window = 4;
  run.stall_timeout = 2.0;
  return {paper_platoon(headway), run};
}

}  // namespace platoon
