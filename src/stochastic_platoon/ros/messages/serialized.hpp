#pragma once

#include <cstddef>
#include <string_view>

namespace platoon {

/// Whether a serialized message of this type that begins with `begin` may have `size` bytes, from the lengths in it.
bool may_have_size(std::string_view type, std::string_view begin, std::size_t size);

/// Whether a serialized message of this type contains the arrays that it announces. ROS allocates the announced memory
/// before it checks the size: one flipped bit can cost gigabytes.
bool holds_its_arrays(std::string_view type, std::string_view bytes);

}  // namespace platoon
