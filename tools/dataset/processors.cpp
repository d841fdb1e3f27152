#include <algorithm>

#include <sched.h>

/// Takes the place of glibc's get_nprocs, which std::thread::hardware_concurrency asks and which counts the processors
/// of the machine: a process that is bound to some of them (taskset, a container, a case of a suite) is not to start
/// more threads than it has processors.
extern "C" int get_nprocs() noexcept {
    cpu_set_t own;
    const bool known = sched_getaffinity(0, sizeof own, &own) == 0;
    return known ? std::max(1, CPU_COUNT(&own)) : 1;
}
