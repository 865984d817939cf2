#pragma once
/// USD packages (.usdz): zip archives whose files are stored without compression.
#include <map>
#include <string>
#include <string_view>

namespace rubble::usd {

inline bool isPackage(std::string_view bytes) { return bytes.starts_with("PK\3\4"); }

class Package {
 public:
  /// Throws Error at `file` if it is not well-formed, or a file in it is compressed or encrypted.
  Package(std::string bytes, const std::string& file);
  /// The root layer is the first file of the package.
  const std::string& root() const { return root_; }
  bool contains(const std::string& name) const { return files_.contains(name); }
  /// Throws Error at `who` if it is not there.
  std::string read(const std::string& name, const std::string& who) const;

 private:
  struct Span {
    std::size_t offset, size;
  };
  std::string bytes_, root_;
  std::map<std::string, Span> files_;
};

}  // namespace rubble::usd
