#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "unit/math/noise/draw.hpp"
#include "unit/messages.hpp"
#include "unit/paper_run.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {

/// A folder for the checkpoints of a run of the paper's example.
class CheckpointTest : public testing::Test {
protected:
  static constexpr std::size_t kCells = 6;

  static MomentTable table(std::uint64_t realizations) {
    MomentTable result(kCells);
    BatchMoments batch(0, realizations, kCells);
    for (std::size_t c = 0; c < kCells; ++c)
      batch.set(c, draw(1, {static_cast<std::uint32_t>(c), 0}, 0, realizations).data());
    result.add(batch);
    return result;
  }

  Checkpoint checkpoint(std::uint64_t realizations) const {
    return {statistics_identity(configuration_),
            configuration_.run.launch_id,
            {1234, 5, 6.75, 8901234567890123456u},
            EnsembleTotals(table(realizations))};
  }

  void write(const Checkpoint& written) const { write_checkpoint(folder_.path(), written); }
  void write(std::uint64_t realizations) const { write(checkpoint(realizations)); }
  std::optional<Checkpoint> read() const { return read_checkpoint(folder_.path()); }

  /// Name and content of the latest checkpoint.
  std::string file() const { return checkpoint_file(folder_.path()); }
  std::string content() const { return content_of(file()); }

  /// The error of starting_point(), or an empty string.
  std::string rejection() const {
    return message_of<ConfigurationError>([this] { starting_point(configuration_); });
  }

  TemporaryFolder folder_;
  Configuration configuration_ = paper_run(folder_.path());
};

}  // namespace platoon
