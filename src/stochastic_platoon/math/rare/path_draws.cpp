#include "stochastic_platoon/math/rare/path_draws.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

void redraw(Lineage& lineage, std::int64_t step, std::uint64_t realization) {
  while (!lineage.empty() && lineage.back().step >= step) lineage.pop_back();
  lineage.push_back({step, realization});
}

std::vector<double> fresh(const WhiteNoise& noise, const std::pair<std::uint32_t, std::int64_t>& name,
                          std::uint64_t first, std::size_t count) {
  std::vector<double> values(count);
  noise.fill({name.first, name.second}, first, count, values.data());
  return values;
}

}  // namespace

PathDraws::PathDraws(std::uint64_t first, std::size_t paths) {
  for (std::size_t s = 0; s < paths; ++s) lineages_.push_back({{-1, first + s}});
}

PathDraws::PathDraws(std::uint64_t first, std::vector<std::shared_ptr<const GivenModes>> modes)
    : PathDraws(first, modes.size()) {
  modes_ = std::move(modes);
}

std::shared_ptr<const PathDraws> PathDraws::only(std::size_t path) const {
  const auto result = std::make_shared<PathDraws>(0, 0);
  result->lineages_ = {lineages_[path]};
  if (!modes_.empty()) result->modes_ = {modes_[path]};
  for (const auto& [name, values] : normals_) result->normals_[name] = {values[path]};
  return result;
}

PathDraws PathDraws::continued(const std::vector<std::pair<std::size_t, std::int64_t>>& parents,
                               const WhiteNoise& noise, std::uint64_t first) const {
  PathDraws result(0, 0);
  for (std::size_t s = 0; s < parents.size(); ++s) {
    result.lineages_.push_back(lineages_[parents[s].first]);
    redraw(result.lineages_.back(), parents[s].second, first + s);
    if (!modes_.empty()) result.modes_.push_back(modes_[parents[s].first]);
  }
  for (const auto& [name, values] : normals_) {
    std::vector<double> draws = fresh(noise, name, first, parents.size());
    for (std::size_t s = 0; s < parents.size(); ++s) {
      if (name.second < parents[s].second) draws[s] = values[parents[s].first];
    }
    result.normals_.emplace_hint(result.normals_.end(), name, std::move(draws));
  }
  return result;
}

PathDraws PathDraws::moved(double kept, const WhiteNoise& noise, std::uint64_t first) const {
  PathDraws result(*this);
  const double share = std::sqrt(1.0 - kept * kept);
  for (auto& [name, values] : result.normals_) {
    const std::vector<double> draws = fresh(noise, name, first, size());
    for (std::size_t s = 0; s < size(); ++s) values[s] = kept * values[s] + share * draws[s];
  }
  return result;
}

PathDraws PathDraws::redrawn(const std::vector<std::int64_t>& from, std::uint64_t first) const {
  PathDraws result(*this);
  for (std::size_t s = 0; s < size(); ++s) {
    if (from[s] >= -1) redraw(result.lineages_[s], from[s], first + s);
  }
  return result;
}

void PathDraws::take(std::size_t path, const PathDraws& other) {
  lineages_[path] = other.lineages_[path];
  if (!modes_.empty()) modes_[path] = other.modes_[path];
  auto theirs = other.normals_.begin();
  for (auto& entry : normals_) entry.second[path] = (theirs++)->second[path];
}

void PathDraws::origins(std::int64_t step, std::uint64_t first, std::size_t count, std::uint64_t* origins) const {
  for (std::size_t s = 0; s < count; ++s) {
    const Lineage& lineage = lineages_[size() == 1 ? 0 : first + s];
    auto segment = lineage.end() - 1;
    while (segment->step > step) --segment;
    origins[s] = segment->realization;
  }
}

void PathDraws::shift(const DrawName& name, std::uint64_t first, std::size_t count, double* normals) const {
  std::vector<double>& values = normals_[{name.vehicle, name.step}];
  if (values.empty()) values.assign(size(), kNaN);
  for (std::size_t s = 0; s < count; ++s) {
    double& value = values[size() == 1 ? 0 : first + s];
    if (std::isnan(value)) value = normals[s];
    normals[s] = value;
  }
}

void PathDraws::replace(const DrawName& name, std::uint64_t first, std::size_t count, double* uniforms) const {
  if (modes_.empty() || name.purpose != Purpose::loss) return;
  for (std::size_t s = 0; s < count; ++s) {
    const GivenModes& modes = *modes_[size() == 1 ? 0 : first + s];
    if (modes.stream == name.vehicle) uniforms[s] = modes.draw(name.step, uniforms[s]);
  }
}

}  // namespace platoon
