// The harnesses accept all inputs of the corpora, and the valid inputs are still valid. Otherwise, after a change of a
// format, the fuzzers would start with seeds that are rejected at once.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "unit/temporary_folder.hpp"

extern "C" {
int fuzz_model_file(const std::uint8_t* data, std::size_t size);
int fuzz_checkpoint(const std::uint8_t* data, std::size_t size);
int fuzz_bag(const std::uint8_t* data, std::size_t size);
int fuzz_message(const std::uint8_t* data, std::size_t size);
}

namespace platoon {
namespace {

const std::string kCorpus = PLATOON_SOURCE_DIR "/test/fuzz/corpus/";

void answers_all_of(const std::string& name, int (*harness)(const std::uint8_t*, std::size_t)) {
  std::size_t inputs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kCorpus + name)) {
    SCOPED_TRACE(entry.path());
    const std::string bytes = content_of(entry.path());
    ASSERT_FALSE(bytes.empty());
    ASSERT_EQ(harness(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
    ++inputs;
  }
  EXPECT_GE(inputs, 2U);
}

TEST(Corpus, IsAnsweredByItsHarness) {
  answers_all_of("model_file", fuzz_model_file);
  answers_all_of("checkpoint", fuzz_checkpoint);
  answers_all_of("bag", fuzz_bag);
  answers_all_of("message", fuzz_message);
}

TEST(Corpus, HoldsAModelFileThatIsOne) {
  EXPECT_NO_THROW(parse_model(load_yaml(kCorpus + "model_file/paper")));
}

TEST(Corpus, HoldsACheckpointThatIsOne) {
  fuzz::write(checkpoint_file(fuzz::folder()), content_of(kCorpus + "checkpoint/whole"));
  EXPECT_TRUE(read_checkpoint(fuzz::folder()));
}

TEST(Corpus, HoldsABagThatIsOne) {
  for (const char* name : {"plain", "packed", "endless"})
    EXPECT_GT(statistics_of_bags({{kCorpus + "bag/" + name}}, {}).result.realizations, 0U) << name;
}

}  // namespace
}  // namespace platoon
