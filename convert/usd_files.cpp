#include "convert/usd_files.h"

#include <filesystem>

#include <rubble/error.h>

namespace rubble::convert {
namespace {

namespace fs = std::filesystem;

std::string inPackage(const std::string& archive, const std::string& name) {
  return archive + "[" + name + "]";
}

/// "model.usdz[arm.usda]" as "model.usdz" and "arm.usda"; the second is empty for a file of a folder.
std::pair<std::string, std::string> parts(const std::string& file) {
  const std::size_t at = file.ends_with(']') ? file.find('[') : std::string::npos;
  if (at == std::string::npos) return {file, ""};
  return {file.substr(0, at), file.substr(at + 1, file.size() - at - 2)};
}

}  // namespace

std::string UsdFiles::open(const std::string& bytes, std::string& file) {
  if (!usd::isPackage(bytes)) return bytes;
  const usd::Package& package = packages_.try_emplace(file, bytes, file).first->second;
  file = inPackage(file, package.root());
  return package.read(package.root(), file);
}

std::string UsdFiles::find(const std::string& asset, const std::string& layer, const std::string& who) {
  const auto [archive, inside] = parts(layer);
  if (!inside.empty()) {
    const std::string name = (fs::path(inside).parent_path() / asset).lexically_normal().generic_string();
    if (!packages_.at(archive).contains(name)) throw Error(who, "a file of the package", "\"" + asset + "\"");
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
  const auto [archive, inside] = parts(file);
  return inside.empty() ? bytesOf(file, who) : packages_.at(archive).read(inside, who);
}

}  // namespace rubble::convert
