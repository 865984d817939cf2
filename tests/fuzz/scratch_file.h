#pragma once
/// Files of targets whose readers take the name of one.
#include <unistd.h>

#include <filesystem>
#include <string>

namespace rubble::fuzz {

/// The name of a file that goes away with the process.
struct ScratchFile {
  std::string path;
  explicit ScratchFile(const std::string& ending)
      : path((std::filesystem::temp_directory_path() / ("rubble_fuzz_" + std::to_string(::getpid()) + ending))
                 .string()) {}
  ~ScratchFile() { std::filesystem::remove(path); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
};

}  // namespace rubble::fuzz
