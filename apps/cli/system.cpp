#include "apps/cli/system.h"

#include <chrono>
#include <ctime>
#include <thread>

#include <fmt/format.h>

#include "platform/system.h"

namespace rubble::cli {
double residentMb() { return static_cast<double>(platform::residentBytes()) / 1e6; }

std::string processorName() {
  const std::string model = platform::processorName();
  return model.empty() ? "unknown processor" : model;
}

std::string machineName() {
  const std::string system = platform::systemName();
  return fmt::format("{}, {} cores, {}", processorName(), threadCount(0),
                     system.empty() ? "unknown system" : system);
}

std::string timestamp() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const std::tm utc = platform::utc(now);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

int threadCount(int requested) {
  if (requested > 0) return requested;
  const unsigned cores = std::thread::hardware_concurrency();
  return cores > 0 ? static_cast<int>(cores) : 1;
}

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace rubble::cli
