// The step on a CPU. Apart from the rest of the engine, because it dominates the compile time of the library.
#include "backend/cpu/cpu_executor.h"

namespace rubble::RUBBLE_CORE {

template void step(CpuExecutor&);

}  // namespace rubble::RUBBLE_CORE
