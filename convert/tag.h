#pragma once
/// Typed attributes of an element. What is read is marked as used, and errors name file, line, element and
/// attribute.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <rubble/error.h>
#include <rubble/math.h>

#include "convert/source.h"

namespace rubble::convert {

class Tag {
 public:
  /// `defaults`: elements that give the attributes which this one lacks, the first one first.
  Tag(Source& source, pugi::xml_node node, std::vector<pugi::xml_node> defaults = {});

  pugi::xml_node node() const { return node_; }
  Source& source() const { return *source_; }
  std::string type() const { return node_.name(); }
  std::string name() const { return text("name").value_or(""); }
  Place place() const { return source_->place(node_); }
  /// "robot.xml:12: joint.range"
  std::string path(const std::string& key) const;
  /// "joint 'knee'"
  std::string describe() const { return type() + inQuotes(name()); }
  [[noreturn]] void fail(const std::string& key, const std::string& expected, const std::string& got) const;

  bool has(const char* key) const { return static_cast<bool>(find(key)); }
  /// Marks all of its own attributes as used: the element is reported as a whole.
  void useAll() const {
    for (const pugi::xml_attribute& attribute : node_.attributes()) source_->use(attribute);
  }
  /// Does the element itself, not a default, have it?
  bool hasOwn(const char* key) const;
  std::optional<std::string> text(const char* key) const;
  /// Fails if it is absent.
  std::string need(const char* key) const;
  /// A finite number of at most kLargest.
  std::optional<double> number(const char* key) const;
  double number(const char* key, double otherwise) const { return number(key).value_or(otherwise); }
  double needNumber(const char* key) const;
  std::optional<int> whole(const char* key, int least, int most) const;
  /// A list of `least` to `most` numbers.
  std::optional<std::vector<double>> numbers(const char* key, std::size_t least, std::size_t most) const;
  std::optional<Vec3> vector(const char* key) const;
  std::optional<std::array<double, 2>> range(const char* key) const;
  /// "true" or "false" (URDF: also 1 or 0).
  std::optional<bool> flag(const char* key) const;
  bool flag(const char* key, bool otherwise) const { return flag(key).value_or(otherwise); }
  /// Index into `names`.
  std::size_t choice(const char* key, const std::vector<std::string>& names, std::size_t otherwise) const;

  /// Largest absolute value of a number in a model. Greater ones are errors: sums of squares of numbers stay
  /// finite in single precision.
  static constexpr double kLargest = 1e15;

 private:
  pugi::xml_attribute find(const char* key) const;

  Source* source_;
  pugi::xml_node node_;
  std::vector<pugi::xml_node> defaults_;
};

}  // namespace rubble::convert
