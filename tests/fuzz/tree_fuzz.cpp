// Any bytes as a tree: only arete::Error may come out, in bounded time and memory, and windows have the values that the whole has
// (guarantee 1 of ElevationTree). Bytes are changed behind the checksums (tree_mutator.h), else none would reach the coders.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/support/checksum.h"
#include "core/support/error.h"
#include "core/support/random.h"
#include "core/tree/elevation_tree.h"
#include "tests/fuzz/tree_mutator.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace arete {
namespace {

constexpr std::int64_t most_cells = 1 << 13;  // of a level that is read as a whole
constexpr int most_side = 256;                // of a node that is decoded, for time: a window needs whole ones

template <class T>
bool is_same(T a, T b) {
  return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
}

[[noreturn]] void report(const char* broken, int level, const Window& at) {
  std::fprintf(stderr, "%s: level %d, window %lld %lld %lld %lld\n", broken, level, static_cast<long long>(at.x), static_cast<long long>(at.y),
               static_cast<long long>(at.width), static_cast<long long>(at.height));
  std::abort();
}

// A window of a level, at most 40 x 40 cells, small ones and those at borders of nodes more often.
Window some_window(const Size& size, std::uint64_t seed, std::uint64_t n) {
  const auto part = [&](std::int64_t cells, std::uint64_t axis) {
    const auto random = [&](std::uint64_t i, std::int64_t below) { return static_cast<std::int64_t>(hash_position(seed, n, axis, i) % static_cast<std::uint64_t>(below)); };
    const std::int64_t length = std::min<std::int64_t>(cells, 1 + random(0, random(1, 2) == 0 ? 4 : 40));
    std::int64_t from = random(2, cells - length + 1);
    if (random(3, 2) == 0) from = std::min(cells - length, std::max<std::int64_t>(0, from / 32 * 32 - random(4, 3)));
    return std::pair(from, length);
  };
  const auto [x, width] = part(size.width, 0);
  const auto [y, height] = part(size.height, 1);
  return {x, y, width, height};
}

struct Cells {
  Raster<double> stored;
  Raster<float> metres;
};

Cells read_cells(const ElevationTree& tree, int level, const Window& at) {
  Cells cells{Raster<double>(at.width, at.height), Raster<float>(at.width, at.height)};
  tree.read_stored(level, at, cells.stored.view());
  tree.read_level(level, at, cells.metres.view());
  return cells;
}

// What is stored is a value of its type, and a void only where both say so (metres may overflow into a NaN of their own).
void check_cells(const ElevationTree& tree, int level, const Window& at, const Cells& cells) {
  for (std::int64_t i = 0; i < at.width * at.height; ++i) {
    const double stored = cells.stored.data()[i];
    if (!std::isnan(stored) && !holds(tree.header().type, stored)) report("a stored value is not of its type", level, at);
    if (std::isnan(stored) && !std::isnan(cells.metres.data()[i])) report("a void has an elevation", level, at);
  }
}

void check_level(const ElevationTree& tree, int level, std::uint64_t seed) {
  const Size size = tree.level_size(level);
  const Window all{0, 0, size.width, size.height};
  const bool small = size.cells() <= most_cells;
  Cells whole;
  if (small) {
    whole = read_cells(tree, level, all);
    check_cells(tree, level, all, whole);
  }
  const Window at = some_window(size, seed, static_cast<std::uint64_t>(level));
  const Cells part = read_cells(tree, level, at);
  check_cells(tree, level, at, part);
  for (std::int64_t y = 0; small && y < at.height; ++y)
    for (std::int64_t x = 0; x < at.width; ++x)
      if (!is_same(part.stored(x, y), whole.stored(at.x + x, at.y + y)) || !is_same(part.metres(x, y), whole.metres(at.x + x, at.y + y)))
        report("a window differs from the whole", level, at);
}

void read_tree(std::span<const std::byte> bytes) {
  const ElevationTree tree(TreeFile(view_bytes(bytes), "fuzz.sct"));
  tree.verify_checksums();
  if (tree.header().grid.side() > most_side) return;
  const std::uint64_t seed = crc32_of(bytes);
  // The finest and the coarsest level and one between them.
  const int levels = tree.levels();
  check_level(tree, levels, seed);
  if (levels > 1) check_level(tree, 1 + static_cast<int>(seed % static_cast<std::uint64_t>(levels - 1)), seed);
  if (levels > 0) check_level(tree, 0, seed);
}

}  // namespace
}  // namespace arete

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    arete::read_tree(std::as_bytes(std::span(data, size)));
  } catch (const arete::Error&) {
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  const std::vector<std::byte> changed = arete::mutate_tree(std::as_bytes(std::span(data, size)), most, seed, LLVMFuzzerMutate);
  std::memcpy(data, changed.data(), changed.size());
  return changed.size();
}
