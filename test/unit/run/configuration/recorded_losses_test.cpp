#include <gtest/gtest.h>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"
#include "unit/run/configuration/model_text.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

class RecordedLosses : public testing::Test {
protected:
  Configuration with(const std::string& keys, std::map<std::string, std::string> given = {}) {
    given["model"] = folder_.file("model.yaml", kModelText + keys);
    return parse_configuration(configuration_document(given));
  }

  /// The problem of a loss, without the folder.
  std::string problem_of(const std::string& loss, const std::map<std::string, std::string>& given = {}) {
    const std::string text = message_of<ConfigurationError>([&] { with("channel: {loss: " + loss + "}\n", given); });
    const std::size_t at = text.find(folder_.path());
    return at == std::string::npos ? text : replaced(text, folder_.path() + "/", "");
  }

  TemporaryFolder folder_;
};

TEST_F(RecordedLosses, AreReadBesideTheModelFileAndKeptInEveryCopy) {
  folder_.file("log.csv", "time;got\n0;1\n0.1;0\n\n0.2;0\n0.3;1\n");
  const Configuration configuration = with(
      "channel: {loss: {trace: log.csv, column: got, on_loss: extrapolate}}\n"
      "vehicle_types: {a: {time_headway: 4}, b: {channel: {loss: {probability: 0.3}}}, c: {channel: {loss: {runs: 3 1}}}}\n"
      "string: [default, a, b, c]\n");
  const Configuration copy = parse_configuration(to_json(configuration).dump());
  EXPECT_EQ(to_json(copy), to_json(configuration));
  for (const Configuration* of : {&configuration, &copy}) {
    const auto loss = [&](std::size_t type) { return *of->model.types[type].vehicle.position().link.loss; };
    for (const std::size_t type : {0, 1}) {
      ASSERT_TRUE(loss(type).trace) << type;
      EXPECT_EQ(loss(type).trace->runs(), "1 2 1");
      EXPECT_DOUBLE_EQ(loss(type).probability, 0.5);
      EXPECT_DOUBLE_EQ(*loss(type).mean_burst, 2.0);
    }
    EXPECT_FALSE(loss(2).trace);
    EXPECT_EQ(loss(2).probability, 0.3);
    EXPECT_FALSE(loss(2).mean_burst);
    EXPECT_EQ(loss(3).trace->runs(), "3 1");
    EXPECT_EQ(loss(3).predictor, (std::vector<double>{2.0, -1.0}));
    EXPECT_TRUE(of->model.types[1].inherited.loss_probability);
    EXPECT_FALSE(of->model.types[3].inherited.loss_probability);
  }
}

TEST_F(RecordedLosses, AreReplacedByAGivenProbability) {
  const PlatoonModel model = with("channel: {loss: {runs: 3 1, on_loss: hold}}\n", {{"loss", "0.2"}}).model;
  EXPECT_FALSE(model.default_vehicle().position().link.loss->trace);
  EXPECT_EQ(model.default_vehicle().position().link.loss->probability, 0.2);
  EXPECT_FALSE(no_theory(model));
}

TEST_F(RecordedLosses, HaveATheoryOnlyIfNothingIsLost) {
  EXPECT_EQ(no_theory(with("channel: {loss: {runs: 7 3}}\n").model),
            "losses follow a recorded trace, of loss probability 0.3 and mean burst 3 (random losses with these two "
            "have a theory)");
  // Strict alternation has none at all.
  EXPECT_EQ(no_theory(with("channel: {loss: {runs: 1 1}}\n").model),
            "losses follow a recorded trace, of loss probability 0.5 and mean burst 1 (independent losses of this "
            "probability have a theory)");
  EXPECT_EQ(no_theory(with("channel: {loss: {probability: 0.5, mean_burst: 1}}\n").model),
            "losses and arrivals alternate (mean_burst: 1 at a probability of 0.5), so that no variance settles");
  const PlatoonModel ones = with("channel: {loss: {runs: '7'}}\n").model;
  EXPECT_FALSE(no_theory(ones));
  EXPECT_TRUE(is_papers(ones));
}

TEST_F(RecordedLosses, AreRejectedWithKeyRowAndReason) {
  folder_.file("two.csv", "received\n1\n2\n");
  folder_.file("none.csv", "received\n");
  folder_.file("lost.csv", "received\n0\n0\n");
  folder_.file("nan.csv", "received\nnan\n");
  const std::string key = "model/channel/loss/";
  EXPECT_EQ(problem_of("{trace: two.csv}"), key + "trace: two.csv: row 3: received: 2: must be 0 or 1");
  EXPECT_EQ(problem_of("{trace: two.csv, column: got}"),
            key + "trace: two.csv: no column got: must be one of received");
  EXPECT_EQ(problem_of("{trace: none.csv}"), key + "trace: none.csv: no entries: must be at least 1");
  EXPECT_EQ(problem_of("{trace: lost.csv}"), key + "trace: lost.csv: nothing arrives: at least one entry must be 1");
  EXPECT_EQ(problem_of("{trace: nan.csv}"), key + "trace: nan.csv: row 2: received: nan: must be a finite number");
  folder_.file("zero.csv", std::string("received\n1\0\n", 12));
  folder_.file("twice.csv", "received,received\n1,0\n");
  EXPECT_EQ(problem_of("{trace: zero.csv}"), key + "trace: zero.csv: row 2: received: 1\\x00: must be a finite number");
  EXPECT_EQ(problem_of("{trace: twice.csv}"),
            key + "trace: twice.csv: row 1: columns 1 and 2 are received: must be one");
  EXPECT_EQ(
      problem_of("{trace: away.csv}"),
      key + "trace: away.csv: must be a regular file of at most 256 MB that can be read (No such file or directory)");
  EXPECT_EQ(problem_of("{runs: 3 1, probability: 0.1}"), key + "probability: given: must be absent beside runs");
  EXPECT_EQ(problem_of("{runs: 3 1}", {{"mean_burst", "2"}}), key + "mean_burst: given: must be absent beside runs");
  EXPECT_EQ(problem_of("{runs: 1 2, on_loss: extrapolate}"),
            key +
                "on_loss: predictions that grow by a factor of 2 over the trace: must be ones that do not grow "
                "(allow_unstable: true runs them anyway)");
}

}  // namespace
}  // namespace platoon
