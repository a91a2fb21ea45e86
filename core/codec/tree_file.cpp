#include "core/codec/tree_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/codec/byte_stream.h"
#include "core/support/checksum.h"
#include "core/support/deflate.h"
#include "core/support/error.h"
#include "core/support/file.h"

namespace arete {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little-endian; this machine would have to swap bytes");

// The first byte is no text, so that nobody takes the file for one.
constexpr std::array<std::uint8_t, 4> magic{0x89, 'S', 'C', 'T'};
constexpr std::uint8_t version = 1;

// At the end: length of the directory, its checksum, the version and the magic's last three bytes.
constexpr std::size_t trailer_bytes = 12;

constexpr std::uint64_t greatest_side = 0x7fffffff;

// Of texts, so that a few bytes of them that unpack to many cannot take more memory than any file should.
constexpr std::size_t greatest_texts = std::size_t{1} << 22;
constexpr std::size_t greatest_items = std::size_t{1} << 16;

// Bits of the first byte of the header's flags.
constexpr std::uint8_t has_transform = 1, is_rotated = 2, has_nodata = 4, is_point = 8, has_voids = 16, is_scaled = 32, has_unit = 64, has_texts = 128;

void put_georeference(const TreeHeader& header, ByteWriter& out) {
  const GeoReference& geo = header.geo;
  if (geo.transform) {
    const std::array<double, 6>& t = *geo.transform;
    for (std::size_t i : {0U, 3U, 1U, 5U}) out.put(t[i]);
    if (t[2] != 0 || t[4] != 0) {
      out.put(t[2]);
      out.put(t[4]);
    }
  }
  if (geo.nodata) out.put(*geo.nodata);
  if (header.scale != 1 || header.offset != 0) {
    out.put(header.scale);
    out.put(header.offset);
  }
  if (geo.vertical_unit != "m" || geo.metres_per_unit != 1) {
    out.put_text(geo.vertical_unit);
    out.put(geo.metres_per_unit);
  }
}

// Texts as a list of strings that end in a zero byte: CRS, name of the band, names and values of the metadata.
std::string texts_of(const TreeHeader& header) {
  std::string texts;
  const auto add = [&](const std::string& text) { texts += text.substr(0, text.find('\0')) + '\0'; };
  add(header.geo.crs_wkt);
  add(header.band_name);
  for (const auto& [key, value] : header.metadata) {
    add(key);
    add(value);
  }
  return texts;
}

bool any_text(const TreeHeader& header) { return !header.geo.crs_wkt.empty() || !header.band_name.empty() || !header.metadata.empty(); }

// Short texts are shorter as they are.
void put_texts(const TreeHeader& header, ByteWriter& out) {
  const std::string texts = texts_of(header);
  if (texts.size() > greatest_texts || header.metadata.size() > greatest_items)
    throw Error(ErrorKind::input, "cannot write the tree: its metadata have " + std::to_string(header.metadata.size()) + " items and, with the CRS, " +
                                      std::to_string(texts.size()) + " bytes; at most " + std::to_string(greatest_items) + " items and " +
                                      std::to_string(greatest_texts) + " bytes fit: leave some out");
  const std::vector<std::byte> packed = deflate_bytes(std::as_bytes(std::span(texts)));
  const bool pack = packed.size() < texts.size();
  out.put_u8(pack);
  pack ? out.put_blob(packed) : out.put_text(texts);
}

std::uint8_t flags_of(const TreeHeader& header) {
  const GeoReference& geo = header.geo;
  std::uint8_t flags = 0;
  const auto set = [&](std::uint8_t flag, bool on) { flags = static_cast<std::uint8_t>(flags | (on ? flag : 0)); };
  set(has_transform, geo.transform.has_value());
  set(is_rotated, geo.transform && ((*geo.transform)[2] != 0 || (*geo.transform)[4] != 0));
  set(has_nodata, geo.nodata.has_value());
  set(is_point, geo.registration == Registration::point);
  set(has_voids, header.voids);
  set(is_scaled, header.scale != 1 || header.offset != 0);
  set(has_unit, geo.vertical_unit != "m" || geo.metres_per_unit != 1);
  set(has_texts, any_text(header));
  return flags;
}

void put_header(const TreeHeader& header, ByteWriter& out) {
  out.put_u8(static_cast<std::uint8_t>(header.coder));
  out.put_u8(static_cast<std::uint8_t>(header.type));
  out.put_varint(static_cast<std::uint64_t>(header.grid.size().width));
  out.put_varint(static_cast<std::uint64_t>(header.grid.size().height));
  out.put_u8(static_cast<std::uint8_t>(std::countr_zero(static_cast<unsigned>(header.grid.side()))));
  out.put_u8(flags_of(header));
  put_georeference(header, out);
  if (any_text(header)) put_texts(header, out);
  out.put_u8(static_cast<std::uint8_t>(header.claim));
  if (header.claim > TreeClaim::lossless) out.put(header.claimed);
  out.put_blob(header.parameters);
  out.put_blob(header.root);
}

void get_georeference(ByteReader& in, std::uint8_t flags, TreeHeader& header) {
  GeoReference& geo = header.geo;
  if (flags & has_transform) {
    std::array<double, 6>& t = geo.transform.emplace();
    for (std::size_t i : {0U, 3U, 1U, 5U}) t[i] = in.get<double>();
    if (flags & is_rotated) {
      t[2] = in.get<double>();
      t[4] = in.get<double>();
    }
    for (double v : t)
      if (!std::isfinite(v)) in.fail("its transform has a number that is not finite");
  } else if (flags & is_rotated) {
    in.fail("it is rotated, but has no transform");
  }
  if (flags & has_nodata) geo.nodata = in.get<double>();
  if (flags & is_scaled) {
    header.scale = in.get<double>();
    header.offset = in.get<double>();
    if (!std::isfinite(header.scale) || header.scale == 0 || !std::isfinite(header.offset)) in.fail("its scale or offset is not a number that can be");
  }
  if (flags & has_unit) {
    geo.vertical_unit = in.get_text();
    geo.metres_per_unit = in.get<double>();
    if (!(geo.metres_per_unit > 0) || !std::isfinite(geo.metres_per_unit)) in.fail("its vertical unit has no length");
  }
  geo.registration = flags & is_point ? Registration::point : Registration::area;
}

void get_texts(ByteReader& in, const std::string& name, TreeHeader& header) {
  const bool packed = in.get_varint(1, "the kind of its texts") == 1;
  std::string texts;
  if (packed) {
    const std::vector<std::byte> bytes = inflate_bytes(in.get_blob(), greatest_texts, name);
    texts.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  } else {
    texts = in.get_text();
  }
  const auto count = static_cast<std::size_t>(std::count(texts.begin(), texts.end(), '\0'));
  if (texts.size() > greatest_texts || count > 2 * greatest_items + 2) in.fail("its texts are too many");
  if (count < 2 || count % 2 != 0 || texts.back() != '\0') in.fail("its texts are not paired");
  std::size_t at = 0;
  const auto next = [&] {
    const std::size_t begin = at;
    at = texts.find('\0', at) + 1;
    return texts.substr(begin, at - 1 - begin);
  };
  header.geo.crs_wkt = next();
  header.band_name = next();
  while (at < texts.size()) {
    std::string key = next();
    if (!header.metadata.emplace(std::move(key), next()).second) in.fail("an item of its metadata comes twice");
  }
}

TreeHeader get_header(ByteReader& in, const std::string& name) {
  TreeHeader header;
  const std::uint8_t coder = in.get_u8(), type = in.get_u8();
  if (coder < 1 || coder > 3) in.fail("coder " + std::to_string(coder) + " does not exist");
  if (type < 1 || type > 7) in.fail("value type " + std::to_string(type) + " does not exist");
  header.coder = static_cast<TreeCoder>(coder);
  header.type = static_cast<ValueType>(type);
  const std::uint64_t width = in.get_varint(greatest_side, "its width"), height = in.get_varint(greatest_side, "its height");
  const std::uint8_t side = in.get_u8();
  if (width == 0 || height == 0) in.fail("it has no cells");
  if (side > 10 || 1 << side < NodeGrid::least_side) in.fail("its nodes have no allowed side");
  header.grid = NodeGrid({static_cast<std::int64_t>(width), static_cast<std::int64_t>(height)}, 1 << side);
  const std::uint8_t flags = in.get_u8();
  header.voids = (flags & has_voids) != 0;
  get_georeference(in, flags, header);
  if (flags & has_texts) get_texts(in, name, header);
  const auto claim = in.get_varint(5, "its claim");
  header.claim = static_cast<TreeClaim>(claim);
  if (header.claim > TreeClaim::lossless) {
    header.claimed = in.get<double>();
    if (!(header.claimed > 0) || !std::isfinite(header.claimed)) in.fail("what it claims is not a positive number");
  }
  const std::span<const std::byte> parameters = in.get_blob(), root = in.get_blob();
  header.parameters.assign(parameters.begin(), parameters.end());
  header.root.assign(root.begin(), root.end());
  return header;
}

std::vector<NodeEntry> get_index(ByteReader& in, const NodeGrid& grid, std::uint64_t begin, std::uint64_t end) {
  // Each node takes a byte of the index at least, so that a count beyond it is a lie.
  const auto count = static_cast<std::uint64_t>(grid.node_count());
  if (count > in.left()) in.fail("its index is shorter than its " + std::to_string(count) + " nodes need");
  std::vector<NodeEntry> nodes(count);
  std::uint64_t position = begin;
  for (NodeEntry& node : nodes) {
    node.position = position;
    node.bytes = static_cast<std::uint32_t>(in.get_varint(0xffffffff, "the length of a node"));
    if (node.bytes > end - position) in.fail("a node reaches beyond the others' end");
    position += node.bytes;
    if (node.bytes > 0) node.checksum = in.get<std::uint32_t>();
  }
  if (position != end) in.fail("its nodes end at byte " + std::to_string(position) + ", its directory begins at " + std::to_string(end));
  if (in.left() != 0) in.fail("its directory goes on after its end");
  return nodes;
}

class FileBytes final : public ByteSource {
 public:
  explicit FileBytes(const std::string& path) : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat about {};
    if (file_ < 0 || ::fstat(file_, &about) != 0) throw Error(ErrorKind::input, "cannot read '" + path + "': " + std::strerror(errno));
    if (S_ISDIR(about.st_mode)) {
      ::close(file_);
      throw Error(ErrorKind::input, "cannot read '" + path + "': it is a folder");
    }
    size_ = static_cast<std::uint64_t>(about.st_size);
  }
  ~FileBytes() override { ::close(file_); }
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t position, std::span<std::byte> to) const override {
    while (!to.empty()) {
      const ssize_t count = ::pread(file_, to.data(), to.size(), static_cast<off_t>(position));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0)
        throw Error(ErrorKind::disk, "cannot read '" + path_ + "': " + (count < 0 ? std::strerror(errno) : "it became shorter meanwhile"));
      to = to.subspan(static_cast<std::size_t>(count));
      position += static_cast<std::uint64_t>(count);
    }
  }

 private:
  std::string path_;
  int file_;
  std::uint64_t size_ = 0;
};

class MemoryBytes final : public ByteSource {
 public:
  explicit MemoryBytes(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t position, std::span<std::byte> to) const override {
    std::copy_n(bytes_.data() + position, to.size(), to.data());
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace

bool is_tree_file(const std::string& path) {
  try {
    const std::vector<std::byte> start = read_file_start(path, magic.size());
    return start.size() == magic.size() && std::memcmp(start.data(), magic.data(), magic.size()) == 0;
  } catch (const Error&) {
    return false;
  }
}

std::shared_ptr<const ByteSource> open_bytes(const std::string& path) { return std::make_shared<FileBytes>(path); }

std::shared_ptr<const ByteSource> view_bytes(std::span<const std::byte> bytes) { return std::make_shared<MemoryBytes>(bytes); }

TreeWriter::TreeWriter(Sink sink) : sink_(std::move(sink)) {
  sink_(std::as_bytes(std::span(magic)));
  position_ = magic.size();
}

void TreeWriter::add_node(std::span<const std::byte> stream) {
  nodes_.push_back({position_, static_cast<std::uint32_t>(stream.size()), crc32_of(stream)});
  if (!stream.empty()) sink_(stream);
  position_ += stream.size();
}

std::uint64_t TreeWriter::finish(const TreeHeader& header) {
  ByteWriter out;
  put_header(header, out);
  for (const NodeEntry& node : nodes_) {
    out.put_varint(node.bytes);
    if (node.bytes > 0) out.put(node.checksum);
  }
  const auto length = static_cast<std::uint32_t>(out.bytes().size());
  const std::uint32_t checksum = crc32_of(out.bytes());
  out.put(length);
  out.put(checksum);
  out.put_u8(version);
  out.put_bytes(std::as_bytes(std::span(magic)).subspan(1));
  sink_(out.bytes());
  return position_ + out.bytes().size();
}

TreeFile::TreeFile(std::shared_ptr<const ByteSource> bytes, std::string name) : bytes_(std::move(bytes)), name_(std::move(name)) {
  const std::uint64_t size = bytes_->size();
  std::array<std::byte, 4> start{};
  if (size >= start.size()) bytes_->read(0, start);
  if (size < start.size() || std::memcmp(start.data(), magic.data(), magic.size()) != 0)
    throw Error(ErrorKind::format, "'" + name_ + "' is not a tree of Arete (.sct): its first bytes are others");
  std::array<std::byte, trailer_bytes> end{};
  const ByteReader file({}, name_);
  if (size < magic.size() + trailer_bytes) file.fail("it is cut short");
  bytes_->read(size - trailer_bytes, end);
  ByteReader trailer(end, name_);
  const auto length = trailer.get<std::uint32_t>(), checksum = trailer.get<std::uint32_t>();
  const std::uint8_t found = trailer.get_u8();
  if (std::memcmp(end.data() + 9, magic.data() + 1, 3) != 0) file.fail("its end is missing");
  if (found > version)
    throw Error(ErrorKind::format, "'" + name_ + "' is a tree of Arete (.sct) of version " + std::to_string(found) + ", this program reads version " +
                                       std::to_string(version) + ": update Arete (or the file is damaged)");
  if (found != version) file.fail("it is of version 0, which there never was");
  if (length > size - trailer_bytes - magic.size()) file.fail("its directory is longer than the file");
  const std::uint64_t directory_at = size - trailer_bytes - length;
  std::vector<std::byte> directory(length);
  bytes_->read(directory_at, directory);
  if (crc32_of(directory) != checksum) file.fail("the checksum of its directory does not agree");
  ByteReader in(directory, name_);
  header_ = get_header(in, name_);
  nodes_ = get_index(in, header_.grid, magic.size(), directory_at);
}

std::vector<std::byte> TreeFile::read_node(std::int64_t index) const {
  const NodeEntry& node = nodes_[static_cast<std::size_t>(index)];
  std::vector<std::byte> stream(node.bytes);
  if (node.bytes == 0) return stream;
  bytes_->read(node.position, stream);
  if (crc32_of(stream) != node.checksum)
    throw Error(ErrorKind::damaged, "'" + name_ + "' is damaged: the checksum of node " + std::to_string(index) + " does not agree; take a fresh copy or make it again");
  return stream;
}

}  // namespace arete
