#include "stochastic_platoon/run/results/age_results.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "stochastic_platoon/math/channel/information_age.hpp"
#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

constexpr std::uint64_t kMostMessages = 10'000'000;

struct LosingLink {
  std::size_t vehicle;
  const char* signal;
  std::uint32_t receiver;
  const LossModel* loss;
};

std::vector<LosingLink> losing_links(const PlatoonModel& model, std::size_t followers) {
  std::vector<LosingLink> links;
  const auto add = [&links](std::size_t i, const LinkModel& link, const char* signal, std::uint32_t receiver) {
    if (link.loses() && !link.loss->by_distance) links.push_back({i, signal, receiver, &*link.loss});
  };
  for (std::size_t i = 1; i <= followers; ++i) {
    const VehicleModel& of = vehicle(model, i);
    const auto receiver = static_cast<std::uint32_t>(i);
    add(i, of.link, "position", receiver);
    if (of.feed_forward) add(i, of.feed_forward->link, "input", receiver + kRadioReceiver);
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
  std::string text = "vehicle,signal,age,count,share,theoretical_share\n";
  for (const LosingLink& link : links) {
    const std::vector<std::uint64_t> counts = count_ages(*link.loss, run.seed, link.receiver, realizations, steps);
    const auto all = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
    for (std::size_t n = 0; n < counts.size(); ++n) {
      text += formatted("%zu,%s,%zu,%llu,%.17g,", link.vehicle, link.signal, n,
                        static_cast<unsigned long long>(counts[n]), static_cast<double>(counts[n]) / all);
      if (!link.loss->trace)
        text += formatted("%.17g", expected_age_share(*link.loss, static_cast<std::int64_t>(n), steps));
      text += "\n";
    }
  }
  return text;
}

}  // namespace platoon
