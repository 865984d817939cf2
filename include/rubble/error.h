#pragma once
#include <stdexcept>
#include <string>

namespace rubble {

/// Invalid input. `path()` names the field ("bodies[3].mass"). `what()` gives the path, the expected value
/// and the actual value.
class Error : public std::runtime_error {
 public:
  Error(std::string path, const std::string& expected, const std::string& got)
      : std::runtime_error(path + ": expected " + expected + ", got " + got), path_(std::move(path)) {}
  explicit Error(const std::string& message) : std::runtime_error(message) {}

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace rubble
