// How fast a tree gives windows and overviews: tree_windows TREE.sct [THREADS]. Opening, the first window of 512 x 512 cells, windows at random
// places once a few were read, and whole levels. The tree should be of a large raster, for instance a mosaic of a DEM.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/support/random.h"
#include "core/tree/elevation_tree.h"

namespace arete {
namespace {

constexpr std::int64_t side = 512;

template <class Work>
double milliseconds(Work work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void print(const char* what, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  std::printf("%-34s median %8.2f ms, nine of ten within %8.2f ms\n", what, times[times.size() / 2], times[times.size() * 9 / 10]);
}

Window random_window(const Size& size, std::uint64_t i) {
  return {static_cast<std::int64_t>(uniform_at(1, i) * static_cast<double>(size.width - side)),
          static_cast<std::int64_t>(uniform_at(2, i) * static_cast<double>(size.height - side)), side, side};
}

void time_windows(const char* path, int threads) {
  std::vector<double> opened, first, later;
  Raster<float> out(side, side);
  for (std::uint64_t i = 0; i < 20; ++i) {
    opened.push_back(milliseconds([&] { ElevationTree::open(path, threads); }));
    const ElevationTree tree = ElevationTree::open(path, threads);
    first.push_back(milliseconds([&] { tree.read(random_window(tree.size(), i), out.view()); }));
  }
  const ElevationTree tree = ElevationTree::open(path, threads);
  for (std::uint64_t i = 0; i < 110; ++i) {
    const double time = milliseconds([&] { tree.read(random_window(tree.size(), 1000 + i), out.view()); });
    if (i >= 10) later.push_back(time);
  }
  print("opening", opened);
  print("first window of 512 x 512", first);
  print("later windows at random places", later);
}

void time_levels(const char* path, int threads) {
  for (int level = 3; level <= 5; ++level) {
    const ElevationTree tree = ElevationTree::open(path, threads);
    const Size size = tree.level_size(level);
    Raster<float> out(size.width, size.height);
    const double time = milliseconds([&] { tree.read_level(level, {0, 0, size.width, size.height}, out.view()); });
    std::printf("level %d: %.1f ms, %.1f Mcell/s of the level, %.0f Mcell/s of the raster under it\n", level, time,
                static_cast<double>(size.cells()) / time / 1e3, static_cast<double>(tree.size().cells()) / time / 1e3);
  }
}

}  // namespace
}  // namespace arete

int main(int count, char** arguments) {
  if (count < 2) {
    std::fprintf(stderr, "usage: tree_windows TREE.sct [THREADS]\n");
    return 2;
  }
  const int threads = count > 2 ? std::atoi(arguments[2]) : 0;
  arete::time_windows(arguments[1], threads);
  if (arete::ElevationTree::open(arguments[1]).levels() >= 5) arete::time_levels(arguments[1], threads);
}
