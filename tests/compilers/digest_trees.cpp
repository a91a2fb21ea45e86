// Digests of what trees decode to and of what rasters are encoded as, for scripts/compare-compilers: `digest_trees FILE...`. Fails where
// 1, 2 and 7 threads differ; other compilers and flags must print the same. Bits are compared, but for those of a NaN: a void has no
// sign. Encoded by the wavelet and the predictive coder; what the patch coder learns is not promised to be the same everywhere.
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "core/support/checksum.h"
#include "core/support/error.h"
#include "core/support/random.h"
#include "core/tree/fit_predictive.h"
#include "core/tree/fit_wavelet.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

template <class T>
std::string digest_of(Raster<T>& cells) {
  for (std::int64_t i = 0; i < cells.size().cells(); ++i)
    if (std::isnan(cells.data()[i])) cells.data()[i] = std::numeric_limits<T>::quiet_NaN();
  return digest_hex(cells.data(), static_cast<std::size_t>(cells.size().cells()) * sizeof(T));
}

// The same text whatever the number of threads, or the end.
std::string for_threads(const std::string& name, const std::function<std::string(int threads)>& make) {
  const std::string text = make(1);
  for (int threads : {2, 7}) {
    if (make(threads) == text) continue;
    std::fprintf(stderr, "digest_trees: %s differs between 1 and %d threads\n", name.c_str(), threads);
    std::exit(1);
  }
  return text;
}

std::string digest_window(const ElevationTree& tree, int level, const Window& at) {
  Raster<double> stored(at.width, at.height);
  Raster<float> metres(at.width, at.height);
  tree.read_stored(level, at, stored.view());
  tree.read_level(level, at, metres.view());
  return digest_of(stored) + " " + digest_of(metres);
}

// Each level, whole and a window of it.
std::string digest_tree(const ElevationTree& tree) {
  std::string text;
  for (int level = 0; level <= tree.levels(); ++level) {
    const Size size = tree.level_size(level);
    text += "  level " + std::to_string(level) + " " + digest_window(tree, level, {0, 0, size.width, size.height}) + "\n";
    text += "  part " + digest_window(tree, level, {size.width / 3, size.height / 4, size.width - size.width / 2, size.height - size.height / 2}) + "\n";
  }
  return text;
}

void print_file(const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  const std::string text = for_threads(name, [&](int threads) { return digest_tree(ElevationTree::open(path, threads)); });
  std::printf("%s\n%s", name.c_str(), text.c_str());
}

// A quarter of a saddle under noise of one metre in integers (no function of the C library, which others compute otherwise), voids in a corner.
MemoryStored make_terrain(std::int64_t width, std::int64_t height, bool voids) {
  Raster<double> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const double noise = static_cast<double>(hash_position(3, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) % 256) / 256;
      const bool is_void = voids && (x + y < 50 || (x * 13 + y * 7) % 101 == 0);
      cells(x, y) = is_void ? std::numeric_limits<double>::quiet_NaN() : std::floor((static_cast<double>(x * x - 2 * x * y + 300 * y) / 64 + noise) * 4) / 4;
    }
  return MemoryStored(std::move(cells));
}

void print_encoded(const std::string& name, const StoredSource& source, ValueType type, TreeClaim kind, double value) {
  TreeHeader header;
  header.type = type;
  header.claim = kind;
  header.claimed = value;
  const TreeCells cells = read_tree_cells(source, header, {});
  const bool strict = kind == TreeClaim::lossless || kind == TreeClaim::max_error;
  const std::string text = for_threads(name, [&](int threads) {
    CompressOptions options;
    options.target = {kind, value};
    options.node_side = 64;
    options.threads = threads;
    const FittedTree fitted = (strict ? fit_predictive : fit_wavelet)(cells, header, options, nullptr);
    const ElevationTree tree(TreeFile(fitted.file, name), threads);
    std::vector<std::byte> file(fitted.file->size());
    fitted.file->read(0, file);
    return std::to_string(file.size()) + " bytes " + digest_hex(file.data(), file.size()) + "\n" + digest_tree(tree);
  });
  std::printf("%s %s", name.c_str(), text.c_str());
}

void print_all(int count, char** paths) {
  for (int i = 0; i < count; ++i) print_file(paths[i]);
  const MemoryStored whole = make_terrain(150, 131, false), holes = make_terrain(133, 170, true);
  print_encoded("rmse", whole, ValueType::float32, TreeClaim::rmse, 0.5);
  print_encoded("rmse, voids", holes, ValueType::int16, TreeClaim::rmse, 2);
  print_encoded("bytes", whole, ValueType::int16, TreeClaim::bytes, 3000);
  print_encoded("lossless", holes, ValueType::float32, TreeClaim::lossless, 0);
  print_encoded("lossless, doubles", make_terrain(90, 70, false), ValueType::float64, TreeClaim::lossless, 0);
  print_encoded("max error", holes, ValueType::float32, TreeClaim::max_error, 0.7);
}

}  // namespace
}  // namespace arete

int main(int count, char** paths) {
  try {
    arete::print_all(count - 1, paths + 1);
  } catch (const arete::Error& error) {
    std::fprintf(stderr, "digest_trees: %s\n", error.what());
    return static_cast<int>(error.kind());
  }
}
