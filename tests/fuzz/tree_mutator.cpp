#include "tests/fuzz/tree_mutator.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <utility>

#include "core/codec/stream_parts.h"
#include "core/codec/tree_file.h"
#include "core/support/checksum.h"
#include "core/support/error.h"

namespace arete {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t magic_bytes = 4, trailer_bytes = 12;
constexpr std::size_t most_growth = 64;  // of a part in one change

// A tree taken to pieces.
struct Pieces {
  TreeHeader header;
  std::vector<Bytes> nodes;
};

std::optional<Pieces> take_apart(std::span<const std::byte> bytes) {
  try {
    const TreeFile file(view_bytes(bytes), "fuzz.sct");
    Pieces pieces{file.header(), {}};
    for (std::size_t i = 0; i < file.nodes().size(); ++i) pieces.nodes.push_back(file.read_node(static_cast<std::int64_t>(i)));
    return pieces;
  } catch (const Error&) {
    return std::nullopt;
  }
}

Bytes put_together(Pieces pieces) {
  Bytes file;
  TreeWriter writer([&](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  pieces.nodes.resize(static_cast<std::size_t>(pieces.header.grid.node_count()));
  for (const Bytes& node : pieces.nodes) writer.add_node(node);
  writer.finish(pieces.header);
  return file;
}

class Mutator {
 public:
  Mutator(std::size_t most, std::uint32_t seed, MutateBytes mutate) : most_(most), random_(seed), mutate_(mutate) {}

  Bytes changed(std::span<const std::byte> file) {
    if (below(16) == 0) return mutated({file.begin(), file.end()});
    std::optional<Pieces> pieces = take_apart(file);
    if (!pieces || below(16) == 0) return resealed(file);
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) change(*pieces);
    return put_together(std::move(*pieces));
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  Bytes mutated(Bytes bytes) {
    const std::size_t most = std::max<std::size_t>(1, std::min(most_, bytes.size() + most_growth));
    const std::size_t before = std::min(bytes.size(), most);
    bytes.resize(most);
    bytes.resize(mutate_(reinterpret_cast<std::uint8_t*>(bytes.data()), before, most));
    return bytes;
  }

  // Any bytes of the directory, under a checksum that fits.
  Bytes resealed(std::span<const std::byte> file) {
    if (file.size() < magic_bytes + trailer_bytes) return mutated({file.begin(), file.end()});
    std::uint32_t length;
    std::memcpy(&length, &file[file.size() - trailer_bytes], sizeof length);
    const std::size_t end = file.size() - trailer_bytes, begin = end - std::min<std::size_t>(length, end - magic_bytes);
    const Bytes directory = mutated({file.begin() + static_cast<std::ptrdiff_t>(begin), file.begin() + static_cast<std::ptrdiff_t>(end)});
    Bytes out(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(begin));
    out.insert(out.end(), directory.begin(), directory.end());
    const std::uint32_t seal[] = {static_cast<std::uint32_t>(directory.size()), crc32_of(directory)};
    const std::span<const std::byte> sealed = std::as_bytes(std::span(seal));
    out.insert(out.end(), sealed.begin(), sealed.end());
    out.insert(out.end(), file.end() - 4, file.end());
    return out;
  }

  void change(Pieces& pieces) {
    switch (below(8)) {
      case 0: pieces.header.parameters = mutated(std::move(pieces.header.parameters)); break;
      case 1: pieces.header.root = changed_stream(pieces.header.root, parts_of(pieces.header)); break;
      case 2: change_header(pieces.header); break;
      case 3:
        if (pieces.nodes.size() > 1) std::swap(pieces.nodes[below(pieces.nodes.size())], pieces.nodes[below(pieces.nodes.size())]);
        break;
      default:
        if (!pieces.nodes.empty()) {
          Bytes& node = pieces.nodes[below(pieces.nodes.size())];
          node = below(8) == 0 ? Bytes{} : changed_stream(node, parts_of(pieces.header));
        }
    }
  }

  // In how many streams one may be taken apart: masks of voids come first, flat water or the like may come next.
  std::size_t parts_of(const TreeHeader& header) { return header.voids + below(2); }

  // A stream, or one of its parts.
  Bytes changed_stream(const Bytes& stream, std::size_t parts) {
    if (parts == 0 || below(8) == 0) return mutated(stream);
    try {
      StreamParts split = split_parts(stream, "fuzz.sct");
      if (below(2) == 0)
        split.first = mutated(std::move(split.first));
      else
        split.rest = changed_stream(split.rest, parts - 1);
      return join_parts(split);
    } catch (const Error&) {
      return mutated(stream);
    }
  }

  // Where the grid changes, streams stay in their order and come to stand for other nodes.
  void change_header(TreeHeader& header) {
    const std::int64_t most_side = below(4) == 0 ? 0x7fffffff : 300;
    Size size = header.grid.size();
    int side = header.grid.side();
    switch (below(8)) {
      case 0: header.coder = static_cast<TreeCoder>(1 + below(3)); break;
      case 1: header.type = static_cast<ValueType>(1 + below(7)); break;
      case 2: size.width = 1 + static_cast<std::int64_t>(random_()) % most_side; break;
      case 3: size.height = 1 + static_cast<std::int64_t>(random_()) % most_side; break;
      case 4: side = 32 << below(6); break;
      case 5: header.voids = !header.voids; break;
      case 6: header.scale = std::bit_cast<double>(std::uint64_t{random_()} << 32 | random_()); break;
      default: header.claim = static_cast<TreeClaim>(below(6)); header.claimed = 1;
    }
    const NodeGrid grid(size, side);
    if (static_cast<std::size_t>(grid.node_count()) < most_) header.grid = grid;
  }

  std::size_t most_;
  std::minstd_rand random_;
  MutateBytes mutate_;
};

}  // namespace

std::vector<std::byte> mutate_tree(std::span<const std::byte> file, std::size_t most, std::uint32_t seed, MutateBytes mutate) {
  Mutator mutator(most, seed, mutate);
  Bytes changed = mutator.changed(file);
  if (changed.size() > most) changed.assign(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(std::min(most, file.size())));
  return changed;
}

}  // namespace arete
