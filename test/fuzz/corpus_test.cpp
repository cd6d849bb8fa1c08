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

extern "C" {
int fuzz_model_file(const std::uint8_t* data, std::size_t size);
int fuzz_checkpoint(const std::uint8_t* data, std::size_t size);
int fuzz_bag(const std::uint8_t* data, std::size_t size);
int fuzz_message(const std::uint8_t* data, std::size_t size);
}

namespace platoon {
namespace {

const std::string kCorpus = PLATOON_SOURCE_DIR "/test/fuzz/corpus/";

void expect_accepted(const std::string& name, int (*harness)(const std::uint8_t*, std::size_t)) {
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

TEST(Corpus, IsAcceptedByItsHarness) {
  expect_accepted("model_file", fuzz_model_file);
  expect_accepted("checkpoint", fuzz_checkpoint);
  expect_accepted("bag", fuzz_bag);
  expect_accepted("message", fuzz_message);
}

TEST(Corpus, HasAValidModelFile) {
  EXPECT_NO_THROW(parse_model(load_yaml(kCorpus + "model_file/paper")));
}

TEST(Corpus, HasAValidCheckpoint) {
  fuzz::folder().file("checkpoint.cbor", content_of(kCorpus + "checkpoint/whole"));
  EXPECT_TRUE(read_checkpoint(fuzz::folder().path()));
}

TEST(Corpus, HasValidBags) {
  for (const char* name : {"plain", "packed", "endless"})
    EXPECT_GT(statistics_of_bags({{kCorpus + "bag/" + name}}, {}).result.realizations, 0U) << name;
}

}  // namespace
}  // namespace platoon
