#include "convert/folders.h"

#include <algorithm>
#include <system_error>

#include <rubble/error.h>

namespace rubble::convert {

namespace fs = std::filesystem;

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
