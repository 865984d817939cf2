#pragma once
/// JSON text as one list of values, which is read once and then released as a whole.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/scene_json.h"

namespace rubble::io {

/// Lists and objects within one another: no file needs more, and what reads one calls itself for each.
inline constexpr std::size_t kMostJsonLevels = 64;

/// Of a JsonDocument. What is inside a value follows it in memory.
class JsonValue {
 public:
  enum class Type : std::uint8_t { Null, Boolean, Negative, Whole, Real, Text, List, Object };

  Type type() const { return type_; }
  bool isList() const { return type_ == Type::List; }
  bool isObject() const { return type_ == Type::Object; }
  bool isText() const { return type_ == Type::Text; }
  bool isBoolean() const { return type_ == Type::Boolean; }
  /// A number without fraction and exponent that 64 bits hold.
  bool isInteger() const { return type_ == Type::Negative || type_ == Type::Whole; }
  bool isNumber() const { return isInteger() || type_ == Type::Real; }

  bool boolean() const { return content_.whole != 0; }
  /// Of a number.
  double number() const;
  /// Of a number that is Type::Whole.
  std::uint64_t whole() const { return content_.whole; }
  std::string_view text() const { return {content_.text, size_}; }
  bool isText(std::string_view text) const { return isText() && this->text() == text; }
  /// Number of elements or members.
  std::size_t size() const { return size_; }
  /// Of a member of an object.
  std::string_view key() const { return {key_, keySize_}; }

  /// Over elements, or over members in the order of the text.
  class Iterator {
   public:
    explicit Iterator(const JsonValue* at) : at_(at) {}
    const JsonValue& operator*() const { return *at_; }
    Iterator& operator++() {
      at_ += at_->span_;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const JsonValue* at_;
  };
  Iterator begin() const { return Iterator(this + 1); }
  Iterator end() const { return Iterator(this + span_); }
  /// The member of a key, the last one if there are several, or null.
  const JsonValue* find(std::string_view key) const;
  /// The last member of each key, by key.
  std::vector<const JsonValue*> members() const;

 private:
  friend class JsonBuilder;

  union {
    std::uint64_t whole;
    std::int64_t negative;
    double real;
    const char* text;
  } content_{};
  const char* key_ = nullptr;
  std::uint32_t keySize_ = 0;
  std::uint32_t size_ = 0;  ///< characters, elements or members
  std::uint32_t span_ = 1;  ///< values from this one to the end of what is inside it
  Type type_ = Type::Null;
};

class JsonDocument {
 public:
  const JsonValue& root() const { return values_.front(); }

 private:
  friend class JsonBuilder;

  std::vector<JsonValue> values_;
  std::vector<std::unique_ptr<char[]>> texts_;  ///< that values refer to
};

/// Parses the text; notes syntax faults with line and column, and keys that appear twice in one object.
std::optional<JsonDocument> parseJson(std::string_view text, std::vector<Fault>& faults);

/// What a value is, in a few words: "a list of 3", "\"abc\"", "-1.5".
std::string describe(const JsonValue& value);
std::string describe(double number);
/// In quotes, and cut if it is long.
std::string describe(std::string_view text);

}  // namespace rubble::io
