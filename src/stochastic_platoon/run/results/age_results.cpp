#include "stochastic_platoon/run/results/age_results.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "stochastic_platoon/math/channel/information_age.hpp"
#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/delivery/batch_schedule.hpp"
#include "stochastic_platoon/run/io/csv_text.hpp"

namespace platoon {

namespace {

constexpr std::uint64_t kMostMessages = 10'000'000;

struct LosingLink {
  std::uint32_t vehicle, input;
  std::string signal;
  const LossModel* loss;
  std::uint32_t stream;  ///< of its losses
};

std::vector<LosingLink> losing_links(const PlatoonModel& model, std::size_t followers) {
  std::vector<LosingLink> links;
  for (std::uint32_t i = 1; i <= followers; ++i) {
    std::uint32_t n = 0;
    for (const Input& input : vehicle(model, i).inputs) {
      const std::uint32_t place = n++;
      if (input.link.loses() && !input.link.loss->by_distance)
        links.push_back({i, place, name_of(input.signal), &*input.link.loss, loss_stream(model, i, place)});
    }
  }
  return links;
}

}  // namespace

std::string ages_csv(const Configuration& configuration, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const std::vector<LosingLink> links = losing_links(configuration.model, run.followers);
  const std::int64_t all_steps = (run.steps == 0 ? result.last_step + 1 : run.steps) - 1;
  if (links.empty() || all_steps < 1 || result.realizations == 0) return "";
  const std::uint64_t of_a_link = std::max<std::uint64_t>(kMostMessages / links.size(), 1);
  const std::int64_t steps = std::min(all_steps, static_cast<std::int64_t>(of_a_link));
  const std::uint64_t realizations =
      std::clamp<std::uint64_t>(of_a_link / static_cast<std::uint64_t>(steps), 1, result.realizations);
  const std::uint64_t first =
      first_noise_realization({run.realizations, run.batch, run.steps}, {result.tally.attempts, 0, 0});
  CsvText csv("vehicle,signal,age,count,share,theoretical_share,input");
  csv.end_row();
  for (const LosingLink& link : links) {
    const std::vector<std::uint64_t> counts = count_ages(*link.loss, run.seed, link.stream, realizations, steps, first);
    const auto all = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
    for (std::size_t n = 0; n < counts.size(); ++n) {
      std::optional<double> expected;
      if (!link.loss->trace) expected = expected_age_share(*link.loss, static_cast<std::int64_t>(n), steps);
      csv.add(link.vehicle, link.signal, n, counts[n], static_cast<double>(counts[n]) / all, expected, link.input);
      csv.end_row();
    }
  }
  return csv.text();
}

}  // namespace platoon
