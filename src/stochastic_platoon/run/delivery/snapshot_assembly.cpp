#include "stochastic_platoon/run/delivery/snapshot_assembly.hpp"

#include <algorithm>

namespace platoon {

namespace {
constexpr std::size_t kMostPositions = 4000000;  // held at once
}

SnapshotAssembly::SnapshotAssembly(std::size_t streams, double period)
    : streams_(streams), period_(period), latest_(streams) {}

void SnapshotAssembly::clear() {
  attempt_ = 0;
  furthest_ = {0, kNothingYet};
  latest_.assign(streams_, {});
  open_.clear();
}

std::optional<Snapshot> SnapshotAssembly::take(std::size_t stream, const MessageId& id, double position, double now) {
  if (id.attempt < attempt_) return std::nullopt;
  if (id.attempt > attempt_) {
    clear();
    attempt_ = id.attempt;
  }
  const Place place{id.first_realization, id.step};
  const Latest before = std::exchange(latest_.at(stream), {place, position});
  if (place > furthest_) {
    furthest_ = place;
    begin_if_due(place, now);
  }
  const bool follows = before.place.first == place.first && before.place.second + 1 == place.second;
  const auto found = open_.find(place);
  if (!follows || found == open_.end()) return std::nullopt;
  Open& open = found->second;
  open.position[stream] = position;
  open.position_before[stream] = before.position;
  if (++open.streams < streams_) return std::nullopt;
  Snapshot snapshot{id, std::move(open.position), std::move(open.position_before)};
  open_.erase(open_.begin(), std::next(found));  // including older, incomplete snapshots
  return snapshot;
}

void SnapshotAssembly::begin_if_due(const Place& place, double now) {
  const bool has_error = place.second >= 0 && place.second % stride_ == 0;
  const bool is_room = 2 * streams_ * (open_.size() + 1) <= kMostPositions || open_.empty();
  constexpr double kEarly = 0.2;  // [periods] tolerance for the jitter of steps that arrive once per period
  if (!has_error || !is_room || now < due_ - kEarly * period_) return;
  due_ = std::max(due_, now - period_) + period_;
  open_.emplace(place, Open{0, std::vector<double>(streams_), std::vector<double>(streams_)});
}

}  // namespace platoon
