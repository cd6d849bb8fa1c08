#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/rare/rare_losses.hpp"

namespace platoon {

/// From this step on, a path has the uniform draws of this realization.
struct LineageSegment {
  std::int64_t step;
  std::uint64_t realization;
};
using Lineage = std::vector<LineageSegment>;  ///< by ascending steps, the first from step -1 on

/// The draws of branched and moved paths; realization s of a simulation is path s. Uniform draws have lineages, normal
/// draws are kept, as are given modes of losses.
class PathDraws : public ChangedDraws {
public:
  /// Paths that begin as realizations first, first + 1, ....
  PathDraws(std::uint64_t first, std::size_t paths);

  /// The same, with losses of these modes, one per path.
  PathDraws(std::uint64_t first, std::vector<std::shared_ptr<const GivenModes>> modes);

  std::size_t size() const { return lineages_.size(); }

  /// The draws of one path, for any realization.
  std::shared_ptr<const PathDraws> only(std::size_t path) const;

  /// Path s as a continuation of path `parents[s].first` from step `parents[s].second` on, with the draws of
  /// realization first + s.
  PathDraws continued(const std::vector<std::pair<std::size_t, std::int64_t>>& parents, const WhiteNoise& noise,
                      std::uint64_t first) const;

  /// The normal draws times `kept` plus those of realization first + s times sqrt(1 - kept^2).
  PathDraws moved(double kept, const WhiteNoise& noise, std::uint64_t first) const;

  /// The uniform draws from step `from[s]` on replaced by those of realization first + s; below -1 none.
  PathDraws redrawn(const std::vector<std::int64_t>& from, std::uint64_t first) const;

  /// Takes over the draws of a path.
  void take(std::size_t path, const PathDraws& other);

  void origins(std::int64_t step, std::uint64_t first, std::size_t count, std::uint64_t* origins) const override;
  void shift(const DrawName& name, std::uint64_t first, std::size_t count, double* normals) const override;
  void replace(const DrawName& name, std::uint64_t first, std::size_t count, double* uniforms) const override;

private:
  using Name = std::pair<std::uint32_t, std::int64_t>;  // vehicle and step

  std::vector<Lineage> lineages_;
  std::vector<std::shared_ptr<const GivenModes>> modes_;  ///< of all paths or none
  mutable std::map<Name, std::vector<double>> normals_;   ///< per path; recorded when the paths are first simulated
};

}  // namespace platoon
