#include "convert/folders.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include <rubble/error.h>

namespace rubble::convert {

namespace fs = std::filesystem;

std::string bytesOf(const fs::path& file, const std::string& who) {
  constexpr std::streamoff kMostBytes = std::streamoff{1} << 29;
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw Error(who, "a file that can be read", "\"" + file.filename().string() + "\"");
  if (in.tellg() > kMostBytes) throw Error(who, "a file of at most 512 MiB", "a larger one");
  in.seekg(0);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

fs::path packageOf(const fs::path& folder) {
  std::error_code failed;
  const fs::path home = fs::weakly_canonical(folder.empty() ? "." : folder, failed);
  if (failed) return folder;
  const auto isRoot = [](const fs::path& at) { return at.parent_path() == at; };
  fs::path at = home;
  for (int level = 0; level <= 4 && !isRoot(at) && !isRoot(at.parent_path()); ++level, at = at.parent_path())
    if (fs::is_regular_file(at / "package.xml", failed)) return at;
  constexpr const char* kKinds[] = {"urdf", "urdfs", "robots", "xml", "xmls", "mjcf", "usd"};
  const bool isKind = std::find(std::begin(kKinds), std::end(kKinds), home.filename()) != std::end(kKinds);
  return isKind && !isRoot(home.parent_path()) ? home.parent_path() : home;
}

void Folders::allow(const fs::path& folder) {
  std::error_code failed;
  const fs::path full = fs::canonical(folder.empty() ? "." : folder, failed);
  if (failed || !fs::is_directory(full, failed)) throw Error(folder.string(), "a folder", "none");
  if (std::find(allowed_.begin(), allowed_.end(), full) == allowed_.end()) allowed_.push_back(full);
}

fs::path Folders::find(const fs::path& base, const std::string& name, const std::string& who) const {
  std::error_code failed;
  const fs::path full = fs::weakly_canonical(base / name, failed);
  if (failed) throw Error(who, "the name of a file", "\"" + name + "\"");
  const bool inside = std::any_of(allowed_.begin(), allowed_.end(), [&](const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), full.begin(), full.end()).first == folder.end();
  });
  if (!inside)
    throw Error(who, "a file in the folder of the model (or in one given by --folder)", "\"" + name + "\"");
  if (!fs::is_regular_file(full, failed)) throw Error(who, "a file that exists", "\"" + name + "\"");
  return full;
}

bool Folders::exists(const fs::path& base, const std::string& name) {
  std::error_code failed;
  return fs::is_regular_file(base / name, failed);
}

}  // namespace rubble::convert
