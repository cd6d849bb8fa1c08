// Reads the records of the bag format (version 2.0) one after the other, without the index that a damaged bag
// lacks. Every length is checked against what is there: the file may hold anything.

#include <rosbag/chunked_file.h>
#include <rosbag/stream.h>

#include <boost/make_shared.hpp>
#include <boost/shared_array.hpp>
#include <cstring>
#include <fstream>
#include <map>

#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/bags/message_dispatch.hpp"
#include "stochastic_platoon/messages/serialized.hpp"

namespace platoon {

namespace {

constexpr char kVersionLine[] = "#ROSBAG V2.0\n";
constexpr std::uint8_t kMessageData = 0x02, kIndexData = 0x04, kChunk = 0x05,
                       kConnection = 0x07;    // values of the field "op"
constexpr std::uint32_t kLongest = 1u << 30;  // of a header or of data: rosbag itself writes nothing near it
constexpr std::uint32_t kLongestChunk = 1u
                                        << 28;  // unpacked; of the longest message and what stands beside it

using Fields = std::map<std::string, std::string>;

struct Cut : std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <typename Number>
Number little_endian(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <typename Number>
Number number_field(const Fields& fields, const std::string& name) {
  const auto field = fields.find(name);
  if (field == fields.end() || field->second.size() != sizeof(Number))
    throw Cut("a record lacks its field " + name);
  return little_endian<Number>(field->second.data());
}

Fields parse_fields(const std::string& header) {
  Fields fields;
  for (std::size_t at = 0; at < header.size();) {
    if (header.size() - at < 4) throw Cut("a header is cut off");
    const auto length = little_endian<std::uint32_t>(header.data() + at);
    at += 4;
    if (length > header.size() - at) throw Cut("a header is cut off");
    const std::string field = header.substr(at, length);
    const std::size_t equals = field.find('=');
    if (equals == std::string::npos) throw Cut("a header makes no sense");
    fields[field.substr(0, equals)] = field.substr(equals + 1);
    at += length;
  }
  return fields;
}

struct Record {
  Fields header;
  std::string data;
};

std::uint32_t next_length(std::istream& stream) {
  char bytes[4];
  stream.read(bytes, 4);
  if (stream.gcount() < 4) throw Cut("a record is cut off");
  const auto length = little_endian<std::uint32_t>(bytes);
  if (length > kLongest) throw Cut("a record makes no sense");
  return length;
}

// In pieces: a length that is nonsense must not take the memory it names.
std::string next_bytes(std::istream& stream, std::uint64_t length) {
  std::string bytes;
  while (bytes.size() < length) {
    const std::size_t piece = std::min<std::size_t>(length - bytes.size(), 1u << 20);
    const std::size_t before = bytes.size();
    bytes.resize(before + piece);
    stream.read(&bytes[before], static_cast<std::streamsize>(piece));
    if (static_cast<std::size_t>(stream.gcount()) < piece) throw Cut("a record is cut off");
  }
  return bytes;
}

// The header of the next record, none at the end. Throws Cut.
std::optional<Fields> next_header(std::istream& stream) {
  if (stream.peek() == std::istream::traits_type::eof()) return std::nullopt;
  return parse_fields(next_bytes(stream, next_length(stream)));
}

std::uint8_t kind_of(const Fields& header) {
  return number_field<std::uint8_t>(header, "op");
}

// The next record, none at the end. Throws Cut.
std::optional<Record> next_record(std::istream& stream) {
  std::optional<Fields> header = next_header(stream);
  if (!header) return std::nullopt;
  Record record{std::move(*header), ""};
  // The records in a chunk that is not compressed stand in the file as they are: its length alone is passed
  // over, so that a chunk that is cut off, or whose length was never written, is read as far as it goes.
  const auto compression = record.header.find("compression");
  if (compression != record.header.end() && compression->second == "none") {
    char length_bytes[4];
    stream.read(length_bytes, 4);
  } else {
    record.data = next_bytes(stream, next_length(stream));
  }
  return record;
}

struct Chunk {
  std::uint64_t begin, end;  ///< of its record in the file
  bool introduces = false;   ///< a connection that no chunk before it has
};

// The chunks from here on up to one that is not whole, told from the lengths of the records and from the index
// behind each chunk.
std::vector<Chunk> whole_chunks(std::istream& stream, std::uint64_t end_of_file) {
  constexpr std::uint64_t kBuffered = 1u << 16;
  std::vector<Chunk> chunks;
  std::set<std::uint32_t> known;
  try {
    while (true) {
      const auto begin = static_cast<std::uint64_t>(stream.tellg());
      const std::optional<Fields> header = next_header(stream);
      if (!header) break;
      const std::uint64_t length = next_length(stream);
      const std::uint64_t end = static_cast<std::uint64_t>(stream.tellg()) + length;
      if (end > end_of_file) break;
      const std::uint8_t kind = kind_of(*header);
      if (kind == kChunk && length == 0) break;  // its length is written when it is whole
      if (kind == kChunk) chunks.push_back({begin, end});
      if (kind == kIndexData && !chunks.empty() &&
          known.insert(number_field<std::uint32_t>(*header, "conn")).second)
        chunks.back().introduces = true;
      if (length < kBuffered) {
        stream.ignore(static_cast<std::streamsize>(length));
      } else {
        stream.seekg(static_cast<std::streamoff>(end));
      }
    }
  } catch (const Cut&) {
  }
  stream.clear();
  return chunks;
}

class DamagedBag {
public:
  explicit DamagedBag(const BagContent& content) : content_(content), streams_(&no_file_) {}

  void read(std::istream& stream) {
    while (const std::optional<Record> record = next_record(stream)) take(*record);
  }

  // Goes to the last `count` chunks. Of those before, whose number is returned, the configuration alone is read.
  std::size_t pass_over(std::istream& stream, std::size_t count) {
    const auto begin = static_cast<std::uint64_t>(stream.tellg());
    stream.seekg(0, std::ios::end);
    const auto end_of_file = static_cast<std::uint64_t>(stream.tellg());
    stream.seekg(static_cast<std::streamoff>(begin));
    const std::vector<Chunk> chunks = whole_chunks(stream, end_of_file);
    const std::size_t before = chunks.size() > count ? chunks.size() - count : 0;
    passing_over_ = true;
    for (std::size_t c = 0; c < before; ++c) {
      if (!chunks[c].introduces) continue;
      stream.seekg(static_cast<std::streamoff>(chunks[c].begin));
      std::istringstream chunk(next_bytes(stream, chunks[c].end - chunks[c].begin));
      read(chunk);
    }
    passing_over_ = false;
    stream.seekg(static_cast<std::streamoff>(before > 0 ? chunks[before].begin : begin));
    return before;
  }

  BagRemainder remainder;

private:
  void take(const Record& record) {
    switch (kind_of(record.header)) {
      case kChunk:
        return take_chunk(record);
      case kConnection:
        return take_connection(record);
      case kMessageData:
        return take_message(record);
      default:
        return;  // the bag's header and index
    }
  }

  void take_chunk(const Record& record) {
    const std::string compression =
        record.header.count("compression") > 0 ? record.header.at("compression") : "";
    if (compression == "none") return;
    const auto size = number_field<std::uint32_t>(record.header, "size");
    const bool lz4 = compression == "lz4";
    // A byte of LZ4 stands for 255 at most.
    const std::uint64_t most = lz4 ? 255 * std::uint64_t{record.data.size()} : kLongestChunk;
    if (in_chunk_ || size > std::min<std::uint64_t>(most, kLongestChunk) || (!lz4 && compression != "bz2"))
      throw Cut("a chunk makes no sense");
    std::string plain(size, '\0'), packed = record.data;
    try {
      streams_.getStream(lz4 ? rosbag::compression::LZ4 : rosbag::compression::BZ2)
          ->decompress(reinterpret_cast<std::uint8_t*>(plain.data()), size,
                       reinterpret_cast<std::uint8_t*>(packed.data()),
                       static_cast<unsigned int>(packed.size()));
    } catch (const rosbag::BagException& error) {
      throw Cut(std::string("a chunk cannot be unpacked: ") + error.what());
    }
    std::istringstream stream(plain);
    in_chunk_ = true;
    read(stream);
    in_chunk_ = false;
  }

  void take_connection(const Record& record) {
    const auto topic = record.header.find("topic");
    if (topic == record.header.end()) throw Cut("a connection lacks its topic");
    const Fields fields = parse_fields(record.data);
    const auto value = [&fields](const char* name) {
      return fields.count(name) > 0 ? fields.at(name) : std::string();
    };
    const TopicReading reading = reading_of(content_, topic->second, value("type"), value("md5sum"));
    if (!reading.topic) remainder.foreign_topics.insert(topic->second);
    readings_[number_field<std::uint32_t>(record.header, "conn")] = reading;
  }

  void take_message(const Record& record) {
    const auto reading = readings_.find(number_field<std::uint32_t>(record.header, "conn"));
    if (reading == readings_.end()) throw Cut("a message has no connection");
    if (!reading->second.wanted) return;
    if (passing_over_ && reading->second.topic->kind != PlatoonTopic::Kind::configuration) return;
    dispatch(content_, *reading->second.topic, [&record](auto message) {
      if (!holds_its_arrays<decltype(message)>(record.data)) throw Cut("a message is cut off");
      std::string data = record.data;
      ros::serialization::IStream stream(reinterpret_cast<std::uint8_t*>(data.data()),
                                         static_cast<std::uint32_t>(data.size()));
      auto found = boost::make_shared<decltype(message)>();
      ros::serialization::deserialize(stream, *found);
      return found;
    });
  }

  const BagContent& content_;
  rosbag::ChunkedFile no_file_;
  rosbag::StreamFactory streams_;
  std::map<std::uint32_t, TopicReading> readings_;
  bool in_chunk_ = false;      ///< that was packed: none is in another
  bool passing_over_ = false;  ///< all but the configuration
};

// Calls `read` with a reader and the file behind the line with its version. What is wrong is told in the remainder.
template <typename Read>
BagRemainder read_with(const std::string& file, const BagContent& content, const Read& read) {
  std::ifstream stream(file, std::ios::binary);
  char version[sizeof kVersionLine - 1];
  stream.read(version, sizeof version);
  if (!stream || std::memcmp(version, kVersionLine, sizeof version) != 0) {
    throw BagError(file + ": is no bag of version 2.0: nothing of it can be read");
  }
  DamagedBag bag(content);
  try {
    read(bag, stream);
  } catch (const Cut& reason) {
    bag.remainder.damage = reason.what();
  } catch (const ros::serialization::StreamOverrunException& reason) {
    bag.remainder.damage = std::string("a message is cut off: ") + reason.what();
  }
  return bag.remainder;
}

}  // namespace

BagRemainder read_damaged_bag(const std::string& file, const BagContent& content) {
  return read_with(file, content, [](DamagedBag& bag, std::istream& stream) { bag.read(stream); });
}

bool read_end_of_bag(const std::string& file, std::size_t chunks, const BagContent& content) {
  bool whole = false;
  read_with(file, content, [&](DamagedBag& bag, std::istream& stream) {
    whole = bag.pass_over(stream, chunks) == 0;
    bag.read(stream);
  });
  return whole;
}

}  // namespace platoon
