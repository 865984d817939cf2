#pragma once
/// Files for tests of what reads them, and numbers as the bytes of either kind of machine.
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

namespace rubble::test {

/// A file that goes away with the test.
struct TemporaryFile {
  std::string path;
  explicit TemporaryFile(const std::string& ending, const std::string& content = "") {
    path = (std::filesystem::temp_directory_path() /
            ("rubble_test_" + std::to_string(std::random_device{}()) + ending))
               .string();
    std::ofstream(path, std::ios::binary) << content;
  }
  ~TemporaryFile() { std::filesystem::remove(path); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
};

/// A folder that goes away with the test.
struct TemporaryFolder {
  std::filesystem::path path;
  TemporaryFolder()
      : path(std::filesystem::temp_directory_path() /
             ("rubble_test_" + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directory(path);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

inline std::string contentOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A number as this machine has it, or, if `swap`, as one of the other byte order does.
template <class T> std::string raw(T value, bool swap = false) {
  std::string bytes(sizeof value, 0);
  std::memcpy(bytes.data(), &value, sizeof value);
  return swap ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}
template <class... T> std::string raws(bool swap, T... values) { return (raw(values, swap) + ...); }

}  // namespace rubble::test
