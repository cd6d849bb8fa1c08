#pragma once

#include <boost/align/aligned_allocator.hpp>
#include <cstddef>
#include <vector>

namespace platoon {

/// Realizations per tile: the states of one vehicle for a tile fit in the first level cache.
constexpr std::size_t kTile = 512;

/// 64-byte aligned, as a load across two cache lines costs two.
using AlignedValues = std::vector<double, boost::alignment::aligned_allocator<double, 64>>;

}  // namespace platoon
