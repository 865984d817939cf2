#pragma once
#include <stdexcept>
#include <string>
#include <utility>

namespace rubble {

/// Invalid input. `path()` names the field ("bodies[3].mass"). `what()` gives the path, the expected value
/// and the actual value. The three parts are empty for an error that is a message only.
class Error : public std::runtime_error {
 public:
  Error(std::string path, std::string expected, std::string got)
      : std::runtime_error(path + ": expected " + expected + ", got " + got),
        path_(std::move(path)),
        expected_(std::move(expected)),
        found_(std::move(got)) {}
  explicit Error(const std::string& message) : std::runtime_error(message) {}

  const std::string& path() const { return path_; }
  const std::string& expected() const { return expected_; }
  const std::string& found() const { return found_; }

 private:
  std::string path_, expected_, found_;
};

}  // namespace rubble
