#include "apps/cli/system.h"

#include <sys/utsname.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>

namespace rubble::cli {
namespace {

/// The text after "key ... :" of the first line of a file that begins with `key`.
std::string valueOf(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(key, 0) != 0) continue;
    const std::size_t colon = line.find(':');
    const std::size_t begin = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "";
}

}  // namespace

double residentMb() {
  double kibibytes = 0;
  std::istringstream(valueOf("/proc/self/status", "VmRSS")) >> kibibytes;
  return kibibytes * 1024 / 1e6;
}

std::string processorName() {
  const std::string model = valueOf("/proc/cpuinfo", "model name");
  return model.empty() ? "unknown processor" : model;
}

std::string machineName() {
  utsname system{};
  const bool known = uname(&system) == 0;
  return fmt::format(
      "{}, {} cores, {}", processorName(), threadCount(0),
      known ? fmt::format("{} {} {}", system.sysname, system.release, system.machine) : "unknown system");
}

std::string timestamp() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
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
