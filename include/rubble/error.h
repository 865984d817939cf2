#pragma once
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <rubble/compiler.h>

namespace rubble {

/// Names a value in its definition: Path("bodies")[3] + ".mass". The text is made when an error needs it, so
/// a valid value costs no string. A Path refers to what it is made of, which must live longer.
class Path {
 public:
  Path(const char* name) : name_{name} {}
  Path(std::string_view name) : name_{name} {}
  Path(const std::string& name) : name_{name} {}

  Path operator+(std::string_view member) const RUBBLE_REFERS_TO_THIS { return {this, member, kNoIndex}; }
  Path operator[](std::size_t element) const RUBBLE_REFERS_TO_THIS { return {this, {}, element}; }

  std::string text() const {
    const std::string own = parent_ ? parent_->text() : std::string();
    return index_ == kNoIndex ? own + std::string(name_) : own + "[" + std::to_string(index_) + "]";
  }

 private:
  static constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);
  Path(const Path* parent, std::string_view name, std::size_t index)
      : parent_{parent}, name_{name}, index_{index} {}

  const Path* parent_ = nullptr;
  std::string_view name_;
  std::size_t index_ = kNoIndex;
};

/// Invalid input. `path()` names the field ("bodies[3].mass"). `what()` gives the path, the expected value
/// and the actual value. The three parts are empty for an error that is a message only.
class Error : public std::runtime_error {
 public:
  Error(const Path& path, std::string expected, std::string got)
      : Error(path.text(), std::move(expected), std::move(got), 0) {}
  explicit Error(const std::string& message) : std::runtime_error(message) {}

  const std::string& path() const { return path_; }
  const std::string& expected() const { return expected_; }
  const std::string& found() const { return found_; }

 private:
  Error(std::string path, std::string expected, std::string got, int)
      : std::runtime_error(path + ": expected " + expected + ", got " + got),
        path_(std::move(path)),
        expected_(std::move(expected)),
        found_(std::move(got)) {}

  std::string path_, expected_, found_;
};

/// Memory could not be allocated. `path()` names the call. If there is none for this either, std::bad_alloc
/// is thrown instead.
class OutOfMemory : public Error {
 public:
  explicit OutOfMemory(const Path& call) : Error(call, "memory for its result", "none left") {}
};

}  // namespace rubble
