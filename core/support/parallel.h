#pragma once

#include <cstdint>
#include <functional>

namespace arete {

/// Threads to use: `requested`, or one per core when it is 0.
int resolve_threads(int requested);

/// Calls body(i) for every i in [0, count), on at most `threads` threads (0: one per core). Which thread takes which i is
/// unspecified: a body writes only what belongs to its i, so that the result is the same for any number of threads.
/// The first exception of a body is thrown again here, after the others have finished.
/// OpenBLAS is held to one thread inside; nested calls run on the same threads.
void parallel_for(std::int64_t count, int threads, const std::function<void(std::int64_t)>& body);

}  // namespace arete
