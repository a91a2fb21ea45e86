#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/codec/node_grid.h"
#include "core/terrain/georeference.h"
#include "core/terrain/value_type.h"

namespace arete {

// The file of a tree (.sct): the streams of its nodes, from the coarsest to the finest, and after them a directory with
// everything else, so that a tree is written in one pass. Laid out to the byte in core/codec/tree-format.md.

/// What the nodes hold.
enum class TreeCoder : std::uint8_t {
  wavelet = 1,     ///< core/codec/wavelet_coder.h: the best quality at a size
  predictive = 2,  ///< core/codec/predictive_coder.h: a strict bound, or lossless
  patches = 3,     ///< core/codec/patch_coder.h: the published model, a dictionary of landforms
};

/// What the encoder promised, and kept.
enum class TreeClaim : std::uint8_t {
  none = 0,
  lossless = 1,   ///< every stored number comes back
  max_error = 2,  ///< no cell is further off than `claimed`, in metres
  psnr = 3,       ///< at least `claimed` dB
  rmse = 4,       ///< at most `claimed` metres
  bytes = 5,      ///< at most `claimed` bytes
};

/// Everything of a tree but the streams of its nodes.
struct TreeHeader {
  TreeCoder coder = TreeCoder::wavelet;
  NodeGrid grid;
  ValueType type = ValueType::float32;  ///< of the stored numbers
  double scale = 1;                     ///< elevation = scale x stored + offset, in the vertical unit
  double offset = 0;
  GeoReference geo;                     ///< crs_wkt as given to the encoder: WKT, or a name like EPSG:4326
  std::string band_name;
  std::map<std::string, std::string> metadata;
  bool voids = false;                   ///< the nodes carry masks
  TreeClaim claim = TreeClaim::none;
  double claimed = 0;
  std::vector<std::byte> parameters;    ///< of the coder
  std::vector<std::byte> root;          ///< the coder's stream of the coarsest level
};

/// Whether a file that can be read begins as a tree's does.
bool is_tree_file(const std::string& path);

/// Where the stream of a node lies.
struct NodeEntry {
  std::uint64_t position = 0;
  std::uint32_t bytes = 0;  ///< 0: the node adds nothing to its parent
  std::uint32_t checksum = 0;
};

/// Bytes of a file by position; safe to call from several threads.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Fills `to`, which lies inside. Throws Error{disk} where reading fails.
  virtual void read(std::uint64_t position, std::span<std::byte> to) const = 0;
};

/// A file of this machine. Throws Error{input} where there is none.
std::shared_ptr<const ByteSource> open_bytes(const std::string& path);
/// Bytes in memory, which must outlive the source.
std::shared_ptr<const ByteSource> view_bytes(std::span<const std::byte> bytes);

/// Puts a tree's file together: nodes in the order of NodeGrid::index, each once, then the directory. `sink` takes the
/// bytes of the file from first to last.
class TreeWriter {
 public:
  using Sink = std::function<void(std::span<const std::byte>)>;
  explicit TreeWriter(Sink sink);
  void add_node(std::span<const std::byte> stream);
  /// Writes the directory; as many nodes as the grid has must have been added. Gives the size of the file.
  std::uint64_t finish(const TreeHeader& header);
  /// Those added so far.
  const std::vector<NodeEntry>& nodes() const { return nodes_; }

 private:
  Sink sink_;
  std::uint64_t position_ = 0;
  std::vector<NodeEntry> nodes_;
};

/// A tree's file, opened. Safe for untrusted bytes; guarantees:
/// 1. each byte of the file is under a checksum or compared with what it must be: one changed byte is noticed, those of a
///    node when the node is read;
/// 2. memory is allocated only for counts that the bytes of the file bear out;
/// 3. the positions of all nodes lie inside the file, in order and without gaps.
class TreeFile {
 public:
  /// Throws Error{format} where the file is no tree or of a newer version, Error{damaged} where it breaks its rules; `name`
  /// stands for the file in messages. Reads the directory only.
  TreeFile(std::shared_ptr<const ByteSource> bytes, std::string name);
  const TreeHeader& header() const { return header_; }
  const std::string& name() const { return name_; }
  std::uint64_t bytes() const { return bytes_->size(); }
  const std::vector<NodeEntry>& nodes() const { return nodes_; }
  /// The stream of a node. Throws Error{damaged} where its checksum fails.
  std::vector<std::byte> read_node(std::int64_t index) const;

 private:
  std::shared_ptr<const ByteSource> bytes_;
  std::string name_;
  TreeHeader header_;
  std::vector<NodeEntry> nodes_;
};

}  // namespace arete
