#pragma once
#include <string>

#include <rubble/error.h>

#include "io/output_file.h"

namespace rubble::convert {

/// Name of a file in the folder of another one, with its ending. The file goes away with this.
class ScratchFile {
 public:
  /// Throws Error if the folder cannot be written.
  explicit ScratchFile(const std::string& beside) : name_(beside) {
    if (name_.path() == beside) throw Error(beside, "a file in a folder that can be written", "another");
  }
  const std::string& path() const { return name_.path(); }

 private:
  io::NewFile name_;  // never kept
};

}  // namespace rubble::convert
