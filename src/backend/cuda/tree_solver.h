#pragma once
/// The kernel that solves small joint trees, in a translation unit of its own.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

struct TreeLaunch {
  void (*kernel)(SolverData, int count, Gate);
  int blocks, threads;
};
/// Solves `count` trees on a device of `threads` resident threads.
TreeLaunch solveTreesWith(int count, int threads);

}  // namespace rubble::RUBBLE_CORE
