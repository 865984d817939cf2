#pragma once
/// The files of a USD stage: in folders, and in packages, where they are named "model.usdz[parts/arm.usda]".
#include <map>
#include <string>

#include "convert/folders.h"
#include "convert/usd/package.h"

namespace rubble::convert {

class UsdFiles {
 public:
  explicit UsdFiles(Folders& folders) : folders_(folders) {}
  /// Content and name of the root layer of a file of which `bytes` is the content.
  std::string open(const std::string& bytes, std::string& file);
  /// The name of an asset that a layer names. Throws Error at `who` if it may not be read.
  std::string find(const std::string& asset, const std::string& layer, const std::string& who);
  std::string read(const std::string& file, const std::string& who);

 private:
  /// A file of a package that has been named.
  struct Packed {
    const usd::Package* package;
    std::string archive, name;
  };
  std::string inPackage(const std::string& archive, const std::string& name);

  Folders& folders_;
  std::map<std::string, usd::Package> packages_;  ///< by the name of the archive
  std::map<std::string, Packed> packed_;          ///< by "archive[name]"
};

}  // namespace rubble::convert
