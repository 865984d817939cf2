// The step on a CPU. Apart from the rest of the engine, because it dominates the compile time of the library.
// Compiled once more for AVX2 by cmake/RubbleVariant.cmake, which defines RUBBLE_AVX2.
#include "backend/cpu/cpu_executor.h"

namespace rubble::RUBBLE_CORE {

#if defined(RUBBLE_AVX2)
void stepAvx2(CpuExecutor& executor);  // src/world/backends.cpp
void stepAvx2(CpuExecutor& executor) { step(executor); }
#else
template void step(CpuExecutor&);
#endif

}  // namespace rubble::RUBBLE_CORE
