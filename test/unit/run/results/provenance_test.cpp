#include "stochastic_platoon/run/results/provenance.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <stdexcept>
#include <string>
#include <system_error>

#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/io/checksum.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "unit/messages.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

class ProvenanceTest : public ResultTest {
protected:
  ProvenanceTest() {
    configuration_ = paper_run(folder_.path(), 2.4);
    configuration_.run.record_compression = "none";
    predict_again();
    write_results(configuration_, prediction_, result());
    text_ = content_of(summary_file());
  }
  std::string summary_file() const { return folder_ / "summary.json"; }
  std::string problem_with(const std::string& text) const {
    return message_of<std::invalid_argument>([&] { read_summary(folder_.file("other.json", text)); });
  }

  std::string text_;
};

TEST_F(ProvenanceTest, ASummaryStatesItsConfigurationAndOrigin) {
  const nlohmann::json summary = nlohmann::json::parse(text_);
  EXPECT_EQ(summary["configuration"], to_json(configuration_));
  EXPECT_EQ(summary["configuration"]["model"]["time_headway"], 2.4);
  EXPECT_EQ(summary["revision"], kRevision);
  EXPECT_TRUE(std::regex_match(summary["date"].get<std::string>(), std::regex(R"(20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ)")))
      << summary["date"];
  EXPECT_NE(summary["host"], "");
  ASSERT_FALSE(summary["command_line"].empty());
  EXPECT_TRUE(contains(summary["command_line"][0].get<std::string>(), "platoon_unit"));
}

TEST_F(ProvenanceTest, TheWholeConfigurationIsReadBack) {
  const RecordedResults found = read_summary(summary_file());
  EXPECT_EQ(to_json(found.configuration), to_json(configuration_));
  EXPECT_TRUE(found.complete);
  EXPECT_EQ(found.checksums.at("statistics"), checksum(content_of(folder_ / "statistics.csv")));
}

TEST_F(ProvenanceTest, TheConfigurationOfARunWithoutNodesIsReadBack) {
  for (const Hosting hosting : {Hosting::monte_carlo, Hosting::bag}) {
    configuration_.run.hosting = hosting;
    write_results(configuration_, prediction_, result());
    EXPECT_EQ(read_summary(summary_file()).configuration.run.hosting, Hosting::one_process);
  }
}

TEST_F(ProvenanceTest, AChangedSummaryIsRejected) {
  for (const char* key : {"\"time_headway\": ", "\"seed\": ", "\"statistics\": \""}) {
    std::string changed = text_;
    const std::size_t place = changed.find(key) + std::string(key).size();
    changed[place] = changed[place] == '3' ? '4' : '3';
    EXPECT_TRUE(contains(problem_with(changed), "damaged")) << key;
  }
  EXPECT_TRUE(contains(problem_with("{}"), "crc32 is missing"));
  EXPECT_TRUE(contains(problem_with(""), "not JSON"));
  EXPECT_THROW(read_summary(folder_ / "none.json"), std::system_error);
  EXPECT_EQ(problem_with(text_), "");
}

}  // namespace
}  // namespace platoon
