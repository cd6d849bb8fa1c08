#include "stochastic_platoon/ros/bags/bag_records.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

namespace platoon {

namespace {

constexpr std::string_view kVersionLine = "#ROSBAG V2.0\n";

// Number of header fields of a record of this kind.
std::size_t fields_of(char kind) {
  switch (static_cast<RecordKind>(kind)) {
    case RecordKind::message:
    case RecordKind::chunk:
    case RecordKind::connection:
      return 3;
    case RecordKind::index:
      return 4;
    case RecordKind::file_header:
      return 5;  // with "encryptor"
    case RecordKind::chunk_info:
      return 6;
  }
  return 0;
}

// Throws if a header is not complete within `begin`: BagDamage if all of its fields are there, so that its length is
// wrong, BagCut if the end of the file has cut fields off.
void require_plausible_header(std::uint32_t length, std::string_view begin) {
  if (length > kLongestHeader) throw BagDamage("a header is longer than any");
  if (length <= begin.size()) return;
  std::size_t fields = 0;
  std::optional<std::size_t> all;
  while (begin.size() >= 4) {
    const auto field_length = little_endian<std::uint32_t>(begin.data());
    begin.remove_prefix(4);
    if (field_length > begin.size()) break;
    if (field_length == 4 && begin.substr(0, 3) == "op=") all = fields_of(begin[3]);
    begin.remove_prefix(field_length);
    ++fields;
  }
  if (all && fields >= *all) throw BagDamage("the length of a header is not that of its fields");
  throw BagCut("a record is cut off");
}

}  // namespace

Fields::Fields(std::string_view bytes) {
  while (!bytes.empty()) {
    if (bytes.size() < 4) throw BagDamage("a header is malformed");
    const auto length = little_endian<std::uint32_t>(bytes.data());
    bytes.remove_prefix(4);
    const std::string_view field = bytes.substr(0, length);
    const std::size_t equals = field.find('=');
    if (length > bytes.size() || equals == std::string_view::npos) throw BagDamage("a header is malformed");
    fields_.push_back({field.substr(0, equals), field.substr(equals + 1)});
    bytes.remove_prefix(length);
  }
}

std::string_view Fields::text(std::string_view name) const {
  for (const Field& field : fields_) {
    if (field.name == name) return field.value;
  }
  return {};
}

bool Fields::has_only(std::initializer_list<std::string_view> names) const {
  return std::all_of(fields_.begin(), fields_.end(), [&names](const Field& field) {
    return std::find(names.begin(), names.end(), field.name) != names.end();
  });
}

bool Fields::operator==(const Fields& other) const {
  return fields_.size() == other.fields_.size() &&
         std::all_of(fields_.begin(), fields_.end(), [&other](const Field& field) {
           return std::any_of(other.fields_.begin(), other.fields_.end(), [&field](const Field& its) {
             return its.name == field.name && its.value == field.value;
           });
         });
}

std::uint32_t take_length(std::string_view& bytes) {
  if (bytes.size() < 4) throw BagCut("a record is cut off");
  const auto length = little_endian<std::uint32_t>(bytes.data());
  bytes.remove_prefix(4);
  return length;
}

Fields take_header(std::string_view& bytes) {
  const std::uint32_t length = take_length(bytes);
  require_plausible_header(length, bytes);
  Fields header(bytes.substr(0, length));
  bytes.remove_prefix(length);
  return header;
}

bool ends_in_first_line(const std::string& file) {
  std::string begin(kVersionLine.size(), ' ');
  std::ifstream stream(file, std::ios::binary);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(stream.gcount()));
  return begin.size() < kVersionLine.size() && kVersionLine.substr(0, begin.size()) == begin;
}

BagBytes::BagBytes(const std::string& file) {
  std::error_code error;
  // Opening a FIFO would wait for its writer.
  if (std::filesystem::is_regular_file(file, error)) stream_.open(file, std::ios::binary);
  if (stream_.is_open()) size_ = std::filesystem::file_size(file, error);
  if (!stream_.is_open() || error) {
    const bool is_active =
        !std::filesystem::exists(file, error) && std::filesystem::exists(file + kActiveSuffix, error);
    const std::string hint =
        is_active ? ". There is " + file + kActiveSuffix + ", of a run that is endless, is still running or was killed"
                  : "";
    throw BagError(file + ": must be a bag, a regular file that can be read" + hint);
  }
  std::string line;
  if (size_ < kVersionLine.size() || take(kVersionLine.size(), line) != kVersionLine)
    throw BagError(file + ": is damaged or no bag: must begin with \"#ROSBAG V2.0\"");
}

std::uint32_t BagBytes::take_length() {
  char bytes[4];
  if (left() < 4 || !stream_.read(bytes, 4)) throw BagCut("a record is cut off");
  position_ += 4;
  return little_endian<std::uint32_t>(bytes);
}

std::string_view BagBytes::take(std::size_t count, std::string& buffer) {
  if (count > left()) throw BagCut("a record is cut off");
  if (buffer.size() < count) buffer.resize(count);
  if (!stream_.read(buffer.data(), static_cast<std::streamsize>(count))) throw BagCut("the file became shorter");
  position_ += count;
  return std::string_view(buffer).substr(0, count);
}

Fields BagBytes::take_header(std::string& buffer) {
  const std::uint32_t length = take_length();
  if (length > kLongestHeader) throw BagDamage("a header is longer than any");
  if (length > left()) require_plausible_header(length, take(left(), buffer));
  return Fields(take(length, buffer));
}

void BagBytes::pass(std::uint64_t count) {
  constexpr std::uint64_t kBuffered = 1u << 16;
  if (count > left()) throw BagCut("a record is cut off");
  if (count >= kBuffered) return seek(position_ + count);
  stream_.ignore(static_cast<std::streamsize>(count));
  position_ += count;
}

void BagBytes::seek(std::uint64_t position) {
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(position));
  position_ = position;
}

}  // namespace platoon
