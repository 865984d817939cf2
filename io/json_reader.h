#pragma once
/// Reads JSON that people write. Each fault is recorded with its path, and reading continues.
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <rubble/math.h>

#include "io/json_value.h"
#include "io/scene_json.h"

namespace rubble::io {

/// Of `names`, those that are like `name`, as a hint: " (did you mean \"mass\"?)"; "" if none is.
std::string hint(std::string_view name, const std::vector<std::string>& names);

/// Bounds of a number, and how the wish for it is put into words.
struct Want {
  double min = -std::numeric_limits<double>::infinity();
  bool minIncluded = true;
  double max = std::numeric_limits<double>::infinity();
  const char* text = "a number";
};
inline constexpr Want kNotNegative{0, true, std::numeric_limits<double>::infinity(),
                                   "a number of at least 0"};
inline constexpr Want kPositive{0, false, std::numeric_limits<double>::infinity(), "a number above 0"};

class Nodes;

/// A JSON value at a path, and the list that faults go to. It refers to the node that it is a part of, which
/// must live longer: its path is put together when a fault needs it.
class Node {
 public:
  /// `path`: of a value that is no part of another.
  Node(const JsonValue& value, std::string_view path, std::vector<Fault>& faults)
      : value_(&value), name_(path), faults_(&faults) {}

  const JsonValue& value() const { return *value_; }
  std::string path() const;
  void fault(const std::string& expected) const;
  void faultText(const std::string& message) const;
  /// The member of a key, or this node if it has none.
  Node child(std::string_view key) const RUBBLE_REFERS_TO_THIS {
    const JsonValue* const found = value_->isObject() ? value_->find(key) : nullptr;
    return found ? member(*found) : *this;
  }
  Node member(const JsonValue& value) const RUBBLE_REFERS_TO_THIS { return {this, value, kNoIndex}; }
  /// The elements of a list; notes a fault and gives none if it is no list.
  Nodes elements(const char* what) const RUBBLE_REFERS_TO_THIS;

  std::optional<double> number(const Want& want = {}) const;
  std::optional<int> whole(int min, const char* text) const;
  std::optional<std::string> text() const;
  std::optional<bool> boolean() const;
  std::optional<Vec3> vector(const Want& each = {}, const char* text = "a list of 3 numbers") const;
  /// The number, or the vector, if it is one within these bounds; notes no fault.
  std::optional<double> numberWithin(const Want& want) const;
  std::optional<Vec3> vectorWithin(const Want& each) const;
  /// One of `names`, by its place in the list.
  std::optional<std::size_t> choice(const std::vector<std::string>& names) const;

 private:
  friend class Nodes;
  static constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);
  Node(const Node* parent, const JsonValue& value, std::size_t index)
      : value_(&value), parent_(parent), index_(index), faults_(parent->faults_) {}

  const JsonValue* value_;
  const Node* parent_ = nullptr;
  std::string_view name_;         ///< path, without a parent
  std::size_t index_ = kNoIndex;  ///< in the list that it is an element of
  std::vector<Fault>* faults_;
};

/// The elements of a list.
class Nodes {
 public:
  class Iterator {
   public:
    Iterator(const Node* list, JsonValue::Iterator at) : list_(list), at_(at) {}
    Node operator*() const { return {list_, *at_, index_}; }
    Iterator& operator++() {
      ++at_, ++index_;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const Node* list_;
    JsonValue::Iterator at_;
    std::size_t index_ = 0;
  };

  Nodes(const Node& list, std::size_t size) : list_(&list), size_(size) {}
  std::size_t size() const { return size_; }
  Iterator begin() const { return {list_, list_->value().begin()}; }
  Iterator end() const { return size_ == 0 ? begin() : Iterator(list_, list_->value().end()); }
  /// All at once, for short lists of which each element has its own meaning.
  operator std::vector<Node>() const {
    std::vector<Node> all;
    for (const Node& element : *this) all.push_back(element);
    return all;
  }

 private:
  const Node* list_;
  std::size_t size_;
};

/// An object with known keys. Keys that were read count as known; finish() reports the others. Nodes that it
/// gives refer to it. Keys must live as long as it does.
class ObjectReader {
 public:
  /// Notes a fault, and then has no keys, if the node is no object.
  explicit ObjectReader(const Node& node, const char* what = "an object");
  ObjectReader(const ObjectReader&) = delete;
  ObjectReader& operator=(const ObjectReader&) = delete;

  bool isObject() const { return isObject_; }
  const Node& node() const { return node_; }
  /// The value of a key, if it is there.
  std::optional<Node> get(std::string_view key);
  /// The same; notes a fault if it is not there.
  std::optional<Node> need(std::string_view key, std::string_view what);
  /// Reports each key that was never read.
  void finish();

  void read(std::string_view key, double& out, const Want& want = {});
  void read(std::string_view key, std::string& out);
  void read(std::string_view key, bool& out);
  void read(std::string_view key, std::uint64_t& out);
  void read(std::string_view key, Vec3& out);

 private:
  Node node_;
  bool isObject_;
  std::vector<std::string_view> known_;
};

}  // namespace rubble::io
