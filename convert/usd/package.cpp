#include "convert/usd/package.h"

#include <algorithm>
#include <cstdint>

#include <rubble/error.h>

namespace rubble::usd {
namespace {

constexpr std::size_t kEndSize = 22, kEntrySize = 46, kHeaderSize = 30, kMostFiles = 65535;

/// Numbers of an archive, low byte first. Throws Error beyond its end.
class Numbers {
 public:
  Numbers(const std::string& bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  std::size_t at(std::size_t offset, std::size_t size) const {
    require(offset, size);
    std::size_t out = 0;
    for (std::size_t i = size; i-- > 0;)
      out = out << 8 | static_cast<std::size_t>(static_cast<unsigned char>(bytes_[offset + i]));
    return out;
  }
  void require(std::size_t offset, std::size_t size) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset)
      throw Error(file_, "a whole zip archive", "one that ends at byte " + std::to_string(bytes_.size()));
  }

 private:
  const std::string& bytes_;
  const std::string& file_;
};

}  // namespace

Package::Package(std::string bytes, const std::string& file) : bytes_(std::move(bytes)) {
  const Numbers n(bytes_, file);
  const std::size_t end = bytes_.rfind("PK\5\6");
  if (end == std::string::npos) throw Error(file, "a zip archive with a directory", "none");
  n.require(end, kEndSize);
  const std::size_t count = n.at(end + 10, 2);
  std::size_t at = n.at(end + 16, 4), first = bytes_.size();
  if (count >= kMostFiles) throw Error(file, "fewer than 65535 files in a package", "more");
  for (std::size_t i = 0; i < count; ++i) {
    if (n.at(at, 4) != 0x02014b50) throw Error(file, "an entry at byte " + std::to_string(at), "none");
    const std::size_t flags = n.at(at + 8, 2), method = n.at(at + 10, 2), size = n.at(at + 24, 4),
                      nameSize = n.at(at + 28, 2), header = n.at(at + 42, 4);
    n.require(at + kEntrySize, nameSize);
    const std::string name = bytes_.substr(at + kEntrySize, nameSize);
    if (method != 0 || (flags & 1) != 0)
      throw Error(file + "[" + name + "]", "a file without compression and encryption", "another one");
    if (n.at(header, 4) != 0x04034b50) throw Error(file + "[" + name + "]", "a file header", "none");
    const std::size_t begin = header + kHeaderSize + n.at(header + 26, 2) + n.at(header + 28, 2);
    n.require(begin, size);
    if (!name.ends_with('/')) {
      files_[name] = {begin, size};
      if (begin < first) first = begin, root_ = name;
    }
    at += kEntrySize + nameSize + n.at(at + 30, 2) + n.at(at + 32, 2);
  }
  if (root_.empty()) throw Error(file, "a package with a layer", "an empty one");
}

std::string Package::read(const std::string& name, const std::string& who) const {
  const auto found = files_.find(name);
  if (found == files_.end()) throw Error(who, "a file of the package", "\"" + name + "\"");
  return bytes_.substr(found->second.offset, found->second.size);
}

}  // namespace rubble::usd
