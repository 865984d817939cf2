#include "platform/system.h"

#include <cerrno>
#include <fstream>
#include <sstream>

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#include <share.h>
#include <sys/stat.h>
#include <cstdlib>
#else
#include <fcntl.h>
#include <sys/utsname.h>
#include <unistd.h>
#endif

namespace rubble::platform {

#if defined(_WIN32)

const char* const kNullFile = "NUL";

std::size_t residentBytes() { return 0; }
std::string processorName() {
  const char* const name = std::getenv("PROCESSOR_IDENTIFIER");
  return name ? name : "";
}
std::string systemName() {
  const char* const type = std::getenv("PROCESSOR_ARCHITECTURE");
  return std::string("Windows ") + (type ? type : "");
}
bool isTerminal(std::FILE* file) { return _isatty(_fileno(file)) != 0; }
std::tm utc(std::time_t time) {
  std::tm out{};
  gmtime_s(&out, &time);
  return out;
}
std::FILE* openFile(const std::filesystem::path& file, const char* mode) {
  return _wfopen(file.c_str(), std::filesystem::path(mode).c_str());
}
bool createFile(const std::filesystem::path& file) {
  int descriptor = -1;
  const int wrong = _wsopen_s(&descriptor, file.c_str(), _O_CREAT | _O_EXCL | _O_WRONLY, _SH_DENYNO,
                              _S_IREAD | _S_IWRITE);
  return wrong == 0 && _close(descriptor) == 0;
}

#else

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

const char* const kNullFile = "/dev/null";

std::size_t residentBytes() {
  std::size_t kibibytes = 0;
  std::istringstream(valueOf("/proc/self/status", "VmRSS")) >> kibibytes;
  return kibibytes * 1024;
}
std::string processorName() { return valueOf("/proc/cpuinfo", "model name"); }
std::string systemName() {
  utsname system{};
  if (uname(&system) != 0) return "";
  return std::string(system.sysname) + " " + system.release + " " + system.machine;
}
bool isTerminal(std::FILE* file) { return isatty(fileno(file)) == 1; }
std::tm utc(std::time_t time) {
  std::tm out{};
  gmtime_r(&time, &out);
  return out;
}
std::FILE* openFile(const std::filesystem::path& file, const char* mode) {
  return std::fopen(file.c_str(), mode);
}
bool createFile(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  return descriptor >= 0 && close(descriptor) == 0;
}

#endif

}  // namespace rubble::platform
