#pragma once
/// The machine and the process that a record was made on.
#include <string>

namespace rubble::cli {

/// Resident memory of this process [MB of 10^6 bytes], 0 where the system does not say.
double residentMb();
/// Model name of the processor.
std::string processorName();
/// Processor, cores and system in one line.
std::string machineName();
/// Now, ISO 8601, UTC.
std::string timestamp();
/// Number of worker threads that `requested` stands for: 0 is one a core.
int threadCount(int requested);
/// The clock on the wall since some fixed moment [s].
double secondsNow();

}  // namespace rubble::cli
