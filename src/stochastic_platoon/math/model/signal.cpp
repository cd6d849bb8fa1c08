#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/input.hpp"

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <set>
#include <sstream>
#include <stdexcept>

namespace platoon {

namespace detail {

template <int kOrder>
PLATOON_INLINE double difference(double y0, double y1, double y2, double y3) {
  if (kOrder == 1) return y0 - y1;
  if (kOrder == 2) return (y0 - y1) - (y1 - y2);
  return ((y0 - y1) - (y1 - y2)) - ((y1 - y2) - (y2 - y3));
}

template <bool kRelative, int kOrder>
PLATOON_INLINE void signal_values(const Signal& signal, const double* predecessor,
                                  const Signal::Recent<const double*>& own, std::size_t count, double* values) {
  const double offset = signal.offset, factor = signal.own.factor;  // local copies cannot alias `values`
  const double *const y0 = own[0], *const y1 = own[kOrder > 0 ? 1 : 0], *const y2 = own[kOrder > 1 ? 2 : 0],
                      *const y3 = own[kOrder > 2 ? 3 : 0];
  for (std::size_t r = 0; r < count; ++r) {
    const double apart = kRelative ? predecessor[r] - y0[r] - offset : 0.0;
    const double moved = kOrder > 0 ? factor * difference<kOrder>(y0[r], y1[r], y2[r], y3[r]) : 0.0;
    values[r] = !kRelative ? moved : kOrder > 0 ? apart + moved : apart;
  }
}

template <bool kRelative>
PLATOON_INLINE void values_of_order(const Signal& signal, const double* predecessor,
                                    const Signal::Recent<const double*>& own, std::size_t count, double* values) {
  switch (signal.own.order) {
    case 0:
      return signal_values<kRelative, 0>(signal, predecessor, own, count, values);
    case 1:
      return signal_values<kRelative, 1>(signal, predecessor, own, count, values);
    case 2:
      return signal_values<kRelative, 2>(signal, predecessor, own, count, values);
    default:
      return signal_values<kRelative, 3>(signal, predecessor, own, count, values);
  }
}

PLATOON_VECTOR_CLONES
void signal_values(const Signal& signal, const double* predecessor, const Signal::Recent<const double*>& own,
                   std::size_t count, double* values) {
  if (signal.is_relative()) return values_of_order<true>(signal, predecessor, own, count, values);
  values_of_order<false>(signal, predecessor, own, count, values);
}

// The value of a signal with any terms.
double value_of(const Signal& signal, Signal::Recent<double> ahead, Signal::Recent<double> own) {
  for (std::size_t j = 0; j < own.size(); ++j) ahead[j] -= own[j];
  const auto of_term = [](const Signal::Term& term, Signal::Recent<double>& y) {
    for (int n = 0; n < term.order; ++n) {
      for (std::size_t j = 0; j + 1 < y.size(); ++j) y[j] -= y[j + 1];
    }
    return term.factor * y[0];
  };
  const double apart = signal.is_relative() ? of_term(signal.apart, ahead) - signal.offset : 0.0;
  return signal.own.order > 0 ? apart + of_term(signal.own, own) : apart;
}

}  // namespace detail

double Signal::operator()(const Recent<double>& ahead, const Recent<double>& behind) const {
  const auto places = [](const Recent<double>& y) { return Recent<const double*>{&y[0], &y[1], &y[2], &y[3]}; };
  double value;
  (*this)(places(ahead), places(behind), 1, &value);
  return value;
}

void Signal::operator()(const Recent<const double*>& ahead, const Recent<const double*>& behind, std::size_t count,
                        double* values) const {
  if (!is_relative() || of_distance() == 1.0) return detail::signal_values(*this, ahead[0], behind, count, values);
  const auto at = [](const Recent<const double*>& y, std::size_t r, int order) {
    Recent<double> recent{};
    for (std::size_t j = 0; j <= static_cast<std::size_t>(order); ++j) recent[j] = y[j][r];
    return recent;
  };
  for (std::size_t r = 0; r < count; ++r)
    values[r] = detail::value_of(*this, at(ahead, r, apart.order), at(behind, r, order()));
}

SignalPositions SignalPositions::from(std::size_t realization) const {
  SignalPositions rest{ahead, own, count - realization, input};
  for (auto* recent : {&rest.ahead, &rest.own}) {
    for (const double*& positions : *recent) positions = positions == nullptr ? nullptr : positions + realization;
  }
  if (input != nullptr) rest.input = input + realization;
  return rest;
}

void SignalPositions::form(const Signal& signal, double* values) const {
  if (!signal.is_input) return signal(ahead, own, count, values);
  if (input == nullptr) throw std::logic_error("the control input is not measured");
  std::copy_n(input, count, values);
}

std::vector<double> SignalPositions::of(const Signal& signal) const {
  std::vector<double> values(count);
  form(signal, values.data());
  return values;
}

Signal tracking_error(const PlatoonModel& model, std::size_t follower) {
  const VehicleModel& own = vehicle(model, follower);
  return {{1.0, 0}, own.standstill_distance, {-own.headway, 1}};
}

namespace {

Signal gap(const PlatoonModel& model, std::size_t follower) {
  return {{1.0, 0}, vehicle(model, follower - 1).length};
}

// D^order y / T_s^order.
Signal derivative(int order, double sample_period) {
  double factor = 1.0;
  for (int i = 0; i < order; ++i) factor /= sample_period;
  return {{}, 0.0, {factor, order}};
}

template <int kOrder>
Signal derivative(const PlatoonModel& model, std::size_t) {
  return derivative(kOrder, model.sample_period);
}

Signal relative_speed(const PlatoonModel& model, std::size_t) {
  return {{1.0 / model.sample_period, 1}};
}

Signal control_input(const PlatoonModel&, std::size_t) {
  return {{}, 0.0, {}, true};
}

}  // namespace

Signal difference(InputSignal signal, double sample_period) {
  return derivative(signal == InputSignal::speed ? 1 : 2, sample_period);
}

const std::vector<SignalKind>& signal_kinds() {
  static const std::vector<SignalKind> kinds{{kGap, "m", gap},
                                             {"speed", "m/s", derivative<1>},
                                             {"acceleration", "m/s^2", derivative<2>},
                                             {"jerk", "m/s^3", derivative<3>},
                                             {kInput, "m/s^2", control_input},
                                             {"relative_speed", "m/s", relative_speed}};
  return kinds;
}

namespace {

const SignalKind& kind_of(const std::string& name) {
  const std::vector<SignalKind>& kinds = signal_kinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const SignalKind& of) { return name == of.name; });
  if (kind == kinds.end()) throw std::invalid_argument("signal " + name + ": must be one of " + all_signal_names());
  return *kind;
}

}  // namespace

bool measures_input(const PlatoonModel& model, const std::vector<std::string>& signals, std::size_t follower) {
  const VehicleModel& own = vehicle(model, follower);
  return own.loop.parts && (own.limits.input || std::find(signals.begin(), signals.end(), kInput) != signals.end());
}

const char* unit_of(const std::string& name) {
  return kind_of(name).unit;
}

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string all_signal_names() {
  std::string names;
  for (const SignalKind& kind : signal_kinds()) names += (names.empty() ? "" : ", ") + std::string(kind.name);
  return names;
}

std::vector<std::string> signal_names(const std::string& text) {
  std::set<std::string> given;
  std::istringstream words(text);
  bool is_list = text.empty() || text.back() != ',';
  for (std::string word; std::getline(words, word, ',');)
    is_list = is_list && given.insert(boost::algorithm::trim_copy(word)).second;
  std::vector<std::string> names;
  for (const SignalKind& kind : signal_kinds()) {
    if (given.count(kind.name) > 0) names.emplace_back(kind.name);
  }
  if (!is_list || names.size() != given.size()) {
    throw std::invalid_argument("signals: " + text + ": must be some of " + all_signal_names() +
                                ", each once, separated by commas");
  }
  return names;
}

FollowerSignals signals_of(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t follower) {
  FollowerSignals signals{tracking_error(model, follower), {}};
  for (const std::string& name : names) signals.requested.push_back(kind_of(name).of(model, follower));
  return signals;
}

SignalLists signal_lists(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
                         std::size_t first) {
  SignalLists lists;
  for (std::size_t i = first; i < first + followers; ++i) {
    const FollowerSignals of = signals_of(model, names, i);
    lists.push_back(names.empty() ? std::vector<Signal>{of.error} : of.requested);
  }
  return lists;
}

std::vector<FollowerSignals> signals_of_all(const PlatoonModel& model, const std::vector<std::string>& names,
                                            std::size_t followers) {
  std::vector<FollowerSignals> all;
  for (std::size_t i = 1; i <= followers; ++i) all.push_back(signals_of(model, names, i));
  return all;
}

std::size_t steps_before(const FollowerSignals& signals) {
  int before = signals.error.order();
  for (const Signal& signal : signals.requested) before = std::max(before, signal.order());
  return static_cast<std::size_t>(before);
}

}  // namespace platoon
