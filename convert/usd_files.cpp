#include "convert/usd_files.h"

#include <filesystem>

#include <rubble/error.h>

namespace rubble::convert {
namespace {

namespace fs = std::filesystem;

/// An asset "model.usdz[arm.usda]" as "model.usdz" and "arm.usda"; the second is empty for other assets.
std::pair<std::string, std::string> parts(const std::string& asset) {
  constexpr std::string_view kEnding = ".usdz";
  const std::size_t at = asset.ends_with(']') ? asset.rfind(std::string(kEnding) + "[") : std::string::npos;
  if (at == std::string::npos) return {asset, ""};
  const std::size_t begin = at + kEnding.size();
  return {asset.substr(0, begin), asset.substr(begin + 1, asset.size() - begin - 2)};
}

}  // namespace

std::string UsdFiles::inPackage(const std::string& archive, const std::string& name) {
  const std::string file = archive + "[" + name + "]";
  packed_[file] = {&packages_.at(archive), archive, name};
  return file;
}

std::string UsdFiles::open(const std::string& bytes, std::string& file) {
  if (!usd::isPackage(bytes)) return bytes;
  const usd::Package& package = packages_.try_emplace(file, bytes, file).first->second;
  file = inPackage(file, package.root());
  return package.read(package.root(), file);
}

std::string UsdFiles::find(const std::string& asset, const std::string& layer, const std::string& who) {
  if (const auto packed = packed_.find(layer); packed != packed_.end()) {
    const auto& [package, archive, inside] = packed->second;
    const std::string name = (fs::path(inside).parent_path() / asset).lexically_normal().generic_string();
    if (!package->contains(name)) throw Error(who, "a file of the package", "\"" + asset + "\"");
    if (fs::path(name).extension() == ".usdz")
      throw Error(who, "no package in a package", "\"" + asset + "\"");
    return inPackage(archive, name);
  }
  const auto [outer, wanted] = parts(asset);
  const std::string file = folders_.find(fs::path(layer).parent_path(), outer, who).string();
  if (fs::path(file).extension() != ".usdz") return file;
  if (!packages_.contains(file)) packages_.try_emplace(file, bytesOf(file, who), file);
  const usd::Package& package = packages_.at(file);
  if (!wanted.empty() && !package.contains(wanted))
    throw Error(who, "a file of the package", "\"" + asset + "\"");
  return inPackage(file, wanted.empty() ? package.root() : wanted);
}

std::string UsdFiles::read(const std::string& file, const std::string& who) {
  const auto packed = packed_.find(file);
  return packed == packed_.end() ? bytesOf(file, who)
                                 : packed->second.package->read(packed->second.name, who);
}

}  // namespace rubble::convert
