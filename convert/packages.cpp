#include "convert/packages.h"

#include <system_error>

#include <rubble/error.h>

namespace rubble::convert {

namespace fs = std::filesystem;

Packages::Packages(Folders& folders, fs::path home, const std::map<std::string, std::string>& given)
    : folders_(folders), home_(std::move(home)) {
  for (const auto& [name, folder] : given) {
    folders_.allow(folder);
    known_[name] = folder;
  }
}

fs::path Packages::folderOf(const std::string& package, const std::string& who) {
  if (const auto known = known_.find(package); known != known_.end()) return known->second;
  const bool isName = !package.empty() && package != "." && package != ".." &&
                      package.find_first_of("/\\") == std::string::npos;
  std::error_code failed;
  for (fs::path at = home_; isName; at = at.parent_path()) {
    for (const fs::path& folder : {at.filename() == package ? at : fs::path(), at / package})
      if (!folder.empty() && fs::is_directory(folder, failed)) {
        folders_.allow(folder);
        return known_[package] = folder;
      }
    // folders at the root of the file system are no packages
    if (at.parent_path() == at.root_path() || at == at.parent_path()) break;
  }
  throw Error(who, "a package at or above the folder of the model (or one given by --package NAME=PATH)",
              "\"" + package + "\"");
}

fs::path Packages::find(const std::string& name, const std::string& who) {
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  if (name.starts_with(kFile)) return folders_.find(home_, name.substr(kFile.size()), who);
  if (!name.starts_with(kPackage)) return folders_.find(home_, name, who);
  const std::string rest = name.substr(kPackage.size());
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) throw Error(who, "package://NAME/path", "\"" + name + "\"");
  return folders_.find(folderOf(rest.substr(0, slash), who), rest.substr(slash + 1), who);
}

}  // namespace rubble::convert
