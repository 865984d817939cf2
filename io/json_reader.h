#pragma once
/// Reads JSON that people write. Each fault is recorded with its path, and reading continues.
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rubble/math.h>

#include "io/scene_json.h"

namespace rubble::io {

using Json = nlohmann::json;

/// What a value is, in a few words: "a list of 3", "\"abc\"", "-1.5".
std::string describe(const Json& value);

/// Of `names`, those that are like `name`, as a hint: " (did you mean \"mass\"?)"; "" if none is.
std::string hint(const std::string& name, const std::vector<std::string>& names);

/// Bounds of a number, and how the wish for it is put into words.
struct Want {
  double min = -std::numeric_limits<double>::infinity();
  bool minIncluded = true;
  double max = std::numeric_limits<double>::infinity();
  const char* text = "a number";
};

/// A JSON value at a path, and the list that faults go to.
class Node {
 public:
  Node(const Json& value, std::string path, std::vector<Fault>& faults)
      : value_(&value), path_(std::move(path)), faults_(&faults) {}

  const Json& value() const { return *value_; }
  const std::string& path() const { return path_; }
  void fault(const std::string& expected) const;
  void faultText(const std::string& message) const;
  Node child(const std::string& key) const;
  /// The elements of a list; notes a fault and gives none if it is no list.
  std::vector<Node> elements(const char* what) const;

  std::optional<double> number(const Want& want = {}) const;
  std::optional<int> whole(int min, const char* text) const;
  std::optional<std::string> text() const;
  std::optional<bool> boolean() const;
  std::optional<Vec3> vector(const Want& each = {}, const char* text = "a list of 3 numbers") const;
  /// One of `names`, by its place in the list.
  std::optional<std::size_t> choice(const std::vector<std::string>& names) const;

 private:
  const Json* value_;
  std::string path_;
  std::vector<Fault>* faults_;
};

/// An object with known keys. Keys that were read count as known; finish() reports the others.
class ObjectReader {
 public:
  /// Notes a fault, and then has no keys, if the node is no object.
  explicit ObjectReader(const Node& node, const char* what = "an object");

  bool isObject() const { return isObject_; }
  const Node& node() const { return node_; }
  /// The value of a key, if it is there.
  std::optional<Node> get(const std::string& key);
  /// The same; notes a fault if it is not there.
  std::optional<Node> need(const std::string& key, const std::string& what);
  /// Reports each key that was never read.
  void finish();

  void read(const std::string& key, double& out, const Want& want = {});
  void read(const std::string& key, std::string& out);
  void read(const std::string& key, bool& out);
  void read(const std::string& key, std::uint64_t& out);
  void read(const std::string& key, Vec3& out);

 private:
  Node node_;
  bool isObject_;
  std::set<std::string> known_;
};

/// Parses the text; notes syntax faults with line and column, and keys that appear twice in one object.
std::optional<Json> parseJson(const std::string& text, std::vector<Fault>& faults);

}  // namespace rubble::io
