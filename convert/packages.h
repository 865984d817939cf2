#pragma once
/// Files that URDF names: "package://NAME/path", "file://path" or a path beside the model.
#include <filesystem>
#include <map>
#include <string>

#include "convert/folders.h"

namespace rubble::convert {

/// Folders of ROS packages. A package that was not given is a folder of its name at or above the folder of
/// the model; its files are then allowed to be read.
class Packages {
 public:
  Packages(Folders& folders, std::filesystem::path home, const std::map<std::string, std::string>& given);
  /// Throws Error at `who` unless the file exists in a folder that may be read.
  std::filesystem::path find(const std::string& name, const std::string& who);

 private:
  std::filesystem::path folderOf(const std::string& package, const std::string& who);

  Folders& folders_;
  std::filesystem::path home_;
  std::map<std::string, std::filesystem::path> known_;
};

}  // namespace rubble::convert
