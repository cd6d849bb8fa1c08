#pragma once

#include <boost/container/small_vector.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <string>
#include <string_view>

#include "stochastic_platoon/ros/bags/bag_source.hpp"

namespace platoon {

/// Values of a record's field "op" (rosbag format, version 2.0).
enum class RecordKind : std::uint8_t {
  message = 0x02,
  file_header = 0x03,
  index = 0x04,
  chunk = 0x05,
  chunk_info = 0x06,
  connection = 0x07
};

constexpr std::size_t kLongestHeader = 1u << 16;  ///< bytes; a topic's name is the longest field
/// Largest chunk [bytes], compressed or not: the longest batch (2^24 positions) and the data that may precede it.
constexpr std::size_t kLongestChunk = 17u << 23;

/// Whether the file is empty, or ends within the first line of a bag.
bool ends_in_first_line(const std::string& file);

template <typename Number>
Number little_endian(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// The fields of a record's header, or of a connection: views into the bytes they were read from.
class Fields {  // NOLINT(bugprone-exception-escape): moving a map throws nothing
public:
  /// Throws BagDamage if the bytes are not a list of fields.
  explicit Fields(std::string_view bytes);

  /// The value of a field; empty if there is none.
  std::string_view text(std::string_view name) const;

  /// The value of a field. Throws BagDamage if there is no field of this name and size.
  template <typename Number>
  Number number(std::string_view name) const {
    const std::string_view value = text(name);
    if (value.size() != sizeof(Number)) throw BagDamage("a record lacks its field " + std::string(name));
    return little_endian<Number>(value.data());
  }

  RecordKind kind() const { return static_cast<RecordKind>(number<std::uint8_t>("op")); }
  bool has_only(std::initializer_list<std::string_view> names) const;

  /// Equal if both have the same fields, in any order.
  bool operator==(const Fields& other) const;
  bool operator!=(const Fields& other) const { return !(*this == other); }

private:
  struct Field {
    std::string_view name, value;
  };
  boost::container::small_vector<Field, 8> fields_;
};

/// Removes a header from the front of `bytes`. Throws BagCut if the bytes end within it, BagDamage if it is not a
/// header.
Fields take_header(std::string_view& bytes);

/// Removes a length from the front of `bytes`. Throws BagCut if the bytes end within it.
std::uint32_t take_length(std::string_view& bytes);

/// A bag as a sequence of bytes. Its functions throw BagCut if the file is shorter than expected.
class BagBytes {
public:
  /// Reads the version line. Throws BagError if the file cannot be read or is not a bag of version 2.0.
  explicit BagBytes(const std::string& file);

  std::uint64_t position() const { return position_; }
  std::uint64_t size() const { return size_; }
  std::uint64_t left() const { return size_ - position_; }

  /// Reads the length that precedes a header or data.
  std::uint32_t take_length();
  /// Reads the next `count` bytes into `buffer`, which grows if necessary.
  std::string_view take(std::size_t count, std::string& buffer);
  /// Reads the next header. Throws BagDamage if it is longer than kLongestHeader.
  Fields take_header(std::string& buffer);
  void pass(std::uint64_t count);
  void seek(std::uint64_t position);

private:
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
};

}  // namespace platoon
