// How fast TINs are made, and how small: tin_speed DEM BOUND... For each bound in metres, greedy insertion alone and with simplification, on one
// thread: triangles, processor seconds (median of five, with reading and measuring), and the raster's cells per second.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "gis/dem_file.h"
#include "gis/tin/make_tin.h"

namespace arete {
namespace {

struct Run {
  std::int64_t triangles = 0;
  double seconds = 0;
};

Run run(const DemReader& dem, double bound, int passes) {
  TinOptions options;
  options.max_error_m = bound;
  options.passes = passes;
  options.threads = 1;
  NoProgress silent;
  std::vector<double> seconds;
  Run result;
  for (int i = 0; i < 5; ++i) {
    const std::clock_t start = std::clock();
    result.triangles = make_tin(dem, options, silent).report.triangles;
    seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::sort(seconds.begin(), seconds.end());
  result.seconds = seconds[2];
  return result;
}

}  // namespace
}  // namespace arete

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: tin_speed DEM BOUND...\n");
    return 2;
  }
  const arete::DemReader dem(argv[1]);
  const double cells = static_cast<double>(dem.size().cells());
  std::printf("%8s %12s %8s %8s %12s %8s %8s %8s\n", "bound m", "insertion", "s", "Mcell/s", "simplified", "s", "Mcell/s", "saved %");
  for (int i = 2; i < argc; ++i) {
    const double bound = std::atof(argv[i]);
    const arete::Run greedy = arete::run(dem, bound, 0), whole = arete::run(dem, bound, arete::TinOptions().passes);
    std::printf("%8g %12lld %8.3f %8.2f %12lld %8.3f %8.2f %8.1f\n", bound, static_cast<long long>(greedy.triangles), greedy.seconds, cells / greedy.seconds / 1e6,
                static_cast<long long>(whole.triangles), whole.seconds, cells / whole.seconds / 1e6,
                100 - 100.0 * static_cast<double>(whole.triangles) / static_cast<double>(greedy.triangles));
  }
}
