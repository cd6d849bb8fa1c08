#include "stochastic_platoon/run/configuration/link_section.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/fraction.hpp"
#include "stochastic_platoon/run/configuration/number_table.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

constexpr std::int64_t kLongestDelay = 10000;
constexpr std::size_t kLongestPredictor = 10;

TransferFunction read_noise_filter(Section& link) {
  Section section = link.section("noise_filter");
  TransferFunction filter = read_fraction(section);
  if (filter.relative_degree() < 0)
    link.reject("noise_filter", "more zeros than poles", "proper: no more zeros than poles");
  const double radius = spectral_radius(delta_form(filter.denominator()));
  if (radius >= 1.0)
    link.reject("noise_filter", formatted("a pole of modulus %g", radius), "stable: poles inside the unit circle");
  return filter;
}

std::vector<double> read_predictor(Section& section, InputSignal signal) {
  if (!section.is_list("on_loss")) {
    std::vector<std::string> names{"hold", "extrapolate", "a list of weights of sum 1 for the last values used"};
    if (signal != InputSignal::position) names.insert(names.begin() + 2, "zero");
    const std::string name = section.choice("on_loss", names);
    if (name == "zero") return {};
    return name == "extrapolate" ? std::vector<double>{2.0, -1.0} : std::vector<double>{1.0};
  }
  const Eigen::VectorXd c = section.numbers("on_loss");
  const double sum = c.sum(), size = c.cwiseAbs().sum();
  if (std::abs(sum - 1.0) > 1e-12 * size) {
    section.reject("on_loss", formatted("weights of sum %g", sum),
                   "of sum 1, as a platoon moves: [1] holds, [2, -1] extrapolates");
  }
  if (static_cast<std::size_t>(c.size()) > kLongestPredictor) {
    section.reject("on_loss", std::to_string(c.size()) + " weights", "at most " + std::to_string(kLongestPredictor));
  }
  return {c.data(), c.data() + c.size()};
}

void check_burst(Section& section, const LossModel& loss) {
  constexpr double kLongestBurst = 1e6;
  const double q = loss.probability, least = loss.least_burst();
  if (*loss.mean_burst > kLongestBurst)
    section.reject("mean_burst", formatted("%g", *loss.mean_burst),
                   formatted("at most %.0f steps: the theory keeps too few digits of longer bursts", kLongestBurst));
  if (*loss.mean_burst >= least) return;
  section.reject(
      "mean_burst", formatted("%g", *loss.mean_burst),
      formatted(
          "at least %g, the larger of 1 and q / (1 - q) for q = %g: no chain has shorter bursts; independent losses have 1 / (1 - q) = %g",
          least, q, loss.independent_burst()));
}

LossTrace trace_of(const std::string& file, const std::string& column) {
  NumberTable table(file, 0, {column});
  std::vector<bool> received;
  while (table.next()) {
    const double value = table.number(0, kLargest);
    if (value != 0.0 && value != 1.0) table.fail_row(column + formatted(": %g: must be 0 or 1", value));
    received.push_back(value == 1.0);
  }
  try {
    return LossTrace(std::move(received));
  } catch (const std::invalid_argument& error) {
    table.fail(error.what());
  }
}

// Rejects keys that exclude the given one.
void require_alone(Section& section, const std::string& key, const std::vector<std::string>& others) {
  for (const std::string& other : others) {
    if (other != key && section.has(other)) section.reject(other, "given", "absent beside " + key);
  }
}

void read_by_distance(Section& section, LossModel& loss) {
  require_alone(section, "by_distance", {"probability", "trace", "runs", "markov"});
  const std::size_t before = section.problems();
  const Eigen::MatrixXd table = section.matrix("by_distance");
  if (section.problems() > before) return;
  if (table.cols() != 2)
    return section.reject("by_distance", std::to_string(table.cols()) + " numbers in a row",
                          "rows of two: gap, probability");
  std::vector<LossByDistance::Point> points;
  for (Eigen::Index j = 0; j < table.rows(); ++j) points.push_back({table(j, 0), table(j, 1)});
  try {
    loss = LossModel{0.0, {}, loss.predictor, {}, LossByDistance(std::move(points))};
  } catch (const std::invalid_argument& error) {
    return section.report(std::string("by_distance: ") + error.what());
  }
  loss.probability = loss.by_distance->largest();
}

// Reads recorded losses, their probability and their mean burst, which is undefined if nothing is lost.
void read_trace(Section& section, LossModel& loss) {
  const std::size_t before = section.problems();
  const bool is_file = section.has("trace");
  const std::string key = is_file ? "trace" : "runs", text = section.text(key);
  const std::string column = section.has("column") ? section.text("column") : "received";
  if (section.problems() > before) return;
  require_alone(section, key, {"probability", "mean_burst", "runs", "markov"});
  loss.by_distance.reset();
  loss.markov.reset();
  try {
    loss.trace = std::make_shared<LossTrace>(is_file ? trace_of(text, column) : LossTrace::of_runs(text));
  } catch (const std::invalid_argument& error) {
    section.report(key + ": " + (is_file ? "" : printable(shortened(text)) + ": ") + error.what());
    return;
  }
  loss.probability = loss.trace->probability();
  loss.mean_burst.reset();
  if (loss.probability > 0.0) loss.mean_burst = loss.trace->mean_burst();
}

// Reads losses by the states of a chain, their probability and their mean burst.
void read_markov(Section& section, LossModel& loss) {
  require_alone(section, "markov", {"probability", "mean_burst", "trace", "runs", "by_distance"});
  Section given = section.section("markov");
  if (!given.is_mapping()) return;
  const std::size_t before = section.problems();
  const Eigen::MatrixXd transition = given.matrix("transition");
  const Eigen::VectorXd probability = given.numbers("probability");
  given.reject_unknown_keys();
  if (section.problems() > before) return;
  try {
    loss = LossModel{0.0, {}, loss.predictor, {}, {}, std::make_shared<MarkovLosses>(transition, probability)};
  } catch (const std::invalid_argument& error) {
    return given.report(error.what());
  }
  loss.probability = loss.markov->loss_probability();
  if (loss.probability > 0.0) loss.mean_burst = loss.markov->mean_burst();
}

void check_trace_growth(Section& section, const LossModel& loss) {
  const double factor = growth(*loss.trace, loss.predictor);
  if (factor < 1.0) return;
  section.reject("on_loss", formatted("predictions that grow by a factor of %g over the trace", factor),
                 "ones that do not grow (allow_unstable: true runs them anyway)");
}

void check_growth(Section& section, const LossModel& loss) {
  const double radius = second_moment_radius(loss);
  if (radius < 1.0) return;
  const double feedback = loss.is_independent() ? loss_feedback(loss) : std::nan("");
  const std::string value = std::isfinite(feedback)
                                ? formatted("predictions whose p q ||L F||^2 is %g", feedback)
                                : formatted("predictions whose variance grows by a factor of %g a step", radius);
  section.reject(
      "on_loss", value,
      formatted(
          "one whose variance settles, p q ||L F||^2 < 1 where losses are independent, for a probability of %g (allow_unstable: true runs it anyway)",
          loss.probability));
}

LossModel read_loss(Section section, const std::optional<LossModel>& base, bool allow_unstable, InputSignal signal) {
  if (!section.is_mapping()) return LossModel();
  const std::size_t before = section.problems();
  LossModel loss = base.value_or(LossModel());
  if (section.has("by_distance")) {
    read_by_distance(section, loss);
  } else if (section.has("trace") || section.has("runs")) {
    read_trace(section, loss);
  } else if (section.has("markov")) {
    read_markov(section, loss);
  } else if (!base && !section.has("probability") && section.has("mean_burst")) {
    section.reject("mean_burst", "given",
                   "beside a loss probability (probability, as an option --loss), as the link loses nothing");
  } else if (!base || section.has("probability")) {
    loss.probability = section.number("probability", kLossProbability);
    if (loss.trace || loss.markov) loss.mean_burst.reset();
    loss.trace.reset();
    loss.by_distance.reset();
    loss.markov.reset();
  }
  if (loss.by_distance && section.has("mean_burst")) require_alone(section, "by_distance", {"mean_burst"});
  if (!loss.trace && !loss.by_distance && !loss.markov && section.has("mean_burst"))
    loss.mean_burst = section.number("mean_burst", kAnyFinite);
  if (!loss.trace && !loss.markov && loss.mean_burst && section.problems() == before) check_burst(section, loss);
  if (section.has("on_loss")) loss.predictor = read_predictor(section, signal);
  section.reject_unknown_keys();
  if (section.problems() > before) return LossModel();
  if (!allow_unstable) loss.trace ? check_trace_growth(section, loss) : check_growth(section, loss);
  return loss;
}

nlohmann::json to_json(const LossModel& loss) {
  nlohmann::json document = {{"on_loss", loss.predictor}};
  if (loss.predictor.empty()) document["on_loss"] = "zero";
  if (loss.trace) {
    document["runs"] = loss.trace->runs();
    return document;
  }
  if (loss.by_distance) {
    document["by_distance"] = loss.by_distance->points();
    return document;
  }
  if (loss.markov) {
    const Eigen::MatrixXd& p = loss.markov->given();
    std::vector<std::vector<double>> rows(static_cast<std::size_t>(p.rows()));
    for (Eigen::Index i = 0; i < p.rows(); ++i) {
      for (Eigen::Index j = 0; j < p.cols(); ++j) rows[static_cast<std::size_t>(i)].push_back(p(i, j));
    }
    const Eigen::VectorXd& l = loss.markov->probability();
    document["markov"] = {{"transition", rows}, {"probability", std::vector<double>(l.data(), l.data() + l.size())}};
    return document;
  }
  document["probability"] = loss.probability;
  if (loss.mean_burst) document["mean_burst"] = *loss.mean_burst;
  return document;
}

}  // namespace

LinkModel read_link(Section section, const LinkModel& base, bool allow_unstable, InputSignal signal) {
  LinkModel link = base;
  if (section.has("noise_filter")) link.noise_filter = read_noise_filter(section);
  if (section.has("quantisation_step")) link.quantisation_step = section.number("quantisation_step", kNotNegative);
  if (section.has("delay")) link.delay = section.integer("delay", 0, kLongestDelay);
  if (section.has("loss")) link.loss = read_loss(section.section("loss"), base.loss, allow_unstable, signal);
  section.reject_unknown_keys();
  return link;
}

nlohmann::json to_json(const LinkModel& link, bool with_defaults) {
  // All members have names, so that a new one does not compile until it is written.
  const auto& [noise_filter, quantisation_step, delay, loss] = link;
  nlohmann::json document = nlohmann::json::object();
  if (with_defaults || !link.has_white_noise()) document["noise_filter"] = to_json(noise_filter);
  if (with_defaults || quantisation_step > 0.0) document["quantisation_step"] = quantisation_step;
  if (with_defaults || delay > 0) document["delay"] = delay;
  if (loss) document["loss"] = to_json(*loss);
  return document;
}

}  // namespace platoon
