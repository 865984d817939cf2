#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace rubble::platform {

/// Full name of a program that is on PATH; "" if none is.
std::string findProgram(const std::string& name);

/// A running program that is written to.
class Program {
 public:
  /// `arguments`: the first is the program's own name. Throws Error if it does not start, and on systems
  /// other than POSIX.
  Program(const std::string& program, std::vector<std::string> arguments);
  ~Program() { wait(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Returns false if the program takes no more.
  bool write(const void* bytes, std::size_t count);
  /// Ends what is written; the exit status, or 128 and the signal.
  int wait();

 private:
  int child_ = 0, pipe_ = -1, status_ = 0;
};

}  // namespace rubble::platform
