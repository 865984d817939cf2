#pragma once
/// Folders that an import may read from. A model names files; none outside of these folders is opened.
#include <filesystem>
#include <string>
#include <vector>

#include "convert/report.h"

namespace rubble::convert {

/// The bytes of a file. Throws Error at `who` if it cannot be read, or has more than 512 MiB.
std::string bytesOf(const std::filesystem::path& file, const std::string& who);

/// The folder that a model belongs to: the package above its own folder (one with a package.xml, at most four
/// levels up), or the one above a folder that is named for its kind of files ("urdf"); else its own.
std::filesystem::path packageOf(const std::filesystem::path& folder);

class Folders {
 public:
  /// Throws Error if there is no such folder.
  void allow(const std::filesystem::path& folder);
  /// The file of that name in `base`. Throws Error at `who` unless it exists and, with links resolved, lies
  /// in an allowed folder.
  std::filesystem::path find(const std::filesystem::path& base, const std::string& name,
                             const std::string& who) const;
  /// Is there such a file?
  static bool exists(const std::filesystem::path& base, const std::string& name);

 private:
  std::vector<std::filesystem::path> allowed_;
};

}  // namespace rubble::convert
