#include "stochastic_platoon/math/model/loss_trace.hpp"

#include <sstream>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

LossTrace::LossTrace(std::vector<bool> received) {
  if (received.empty()) throw std::invalid_argument("no entries: must be at least 1");
  if (received.size() > kLongest)
    throw std::invalid_argument(
        formatted("%zu entries: must be at most %zu", received.size(), static_cast<std::size_t>(kLongest)));
  lost_.reserve(received.size());
  std::size_t losses = 0, bursts = 0;
  for (std::size_t k = 0; k < received.size(); ++k) {
    lost_.push_back(received[k] ? 0 : 1);
    losses += lost_.back();
    if (!received[k] && received[k == 0 ? received.size() - 1 : k - 1]) ++bursts;
  }
  if (losses == received.size()) throw std::invalid_argument("nothing arrives: at least one entry must be 1");
  probability_ = static_cast<double>(losses) / static_cast<double>(lost_.size());
  if (bursts > 0) mean_burst_ = static_cast<double>(losses) / static_cast<double>(bursts);
}

LossTrace LossTrace::of_runs(const std::string& runs) {
  std::vector<bool> received;
  std::istringstream numbers(runs);
  bool arrives = true;
  for (long long run = 0; numbers >> run; arrives = !arrives) {
    if (run < (received.empty() && arrives ? 0 : 1) || static_cast<std::size_t>(run) > kLongest - received.size())
      throw std::invalid_argument(
          formatted("a run of %lld entries: runs must be positive (only the first may be 0), %zu entries in all", run,
                    static_cast<std::size_t>(kLongest)));
    received.insert(received.end(), static_cast<std::size_t>(run), arrives);
  }
  if (!numbers.eof())
    throw std::invalid_argument(
        formatted("must be a list of whole numbers, %zu entries in all", static_cast<std::size_t>(kLongest)));
  return LossTrace(std::move(received));
}

std::string LossTrace::runs() const {
  std::string text;
  std::size_t begin = 0;
  for (bool arrives = true; begin < lost_.size(); arrives = !arrives) {
    std::size_t end = begin;
    while (end < lost_.size() && (lost_[end] == 0) == arrives) ++end;
    text += (text.empty() ? "" : " ") + std::to_string(end - begin);
    begin = end;
  }
  return text;
}

}  // namespace platoon
