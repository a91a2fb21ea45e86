#include "core/support/parallel.h"

#include <thread>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

extern "C" void openblas_set_num_threads(int count);

namespace arete {

int resolve_threads(int requested) {
  if (requested > 0) return requested;
  const unsigned cores = std::thread::hardware_concurrency();
  return cores == 0 ? 1 : static_cast<int>(cores);
}

void parallel_for(std::int64_t count, int threads, const std::function<void(std::int64_t)>& body) {
  // Parallelism is ours; a product that changes its split with the machine would change its last bits too.
  static const bool single_threaded_blas = (openblas_set_num_threads(1), true);
  (void)single_threaded_blas;
  const int workers = resolve_threads(threads);
  if (workers == 1 || count < 2) {
    for (std::int64_t i = 0; i < count; ++i) body(i);
    return;
  }
  // More threads than cores are the caller's choice; without this TBB would warn on stderr and use fewer.
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(workers));
  tbb::task_arena arena(workers);
  arena.execute([&] {
    tbb::parallel_for(std::int64_t{0}, count, body, tbb::simple_partitioner());
  });
}

}  // namespace arete
