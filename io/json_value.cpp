#include "io/json_value.h"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace rubble::io {

using Unordered = nlohmann::json;

double JsonValue::number() const {
  switch (type_) {
    case Type::Whole:
      return static_cast<double>(content_.whole);
    case Type::Negative:
      return static_cast<double>(content_.negative);
    default:
      return content_.real;
  }
}

const JsonValue* JsonValue::find(std::string_view key) const {
  const JsonValue* found = nullptr;
  for (const JsonValue& member : *this)
    if (member.key() == key) found = &member;
  return found;
}

std::vector<const JsonValue*> JsonValue::members() const {
  std::vector<const JsonValue*> list;
  for (const JsonValue& member : *this) list.push_back(&member);
  std::ranges::stable_sort(list, {}, &JsonValue::key);
  std::vector<const JsonValue*> last;
  for (const JsonValue* const member : list)
    if (!last.empty() && last.back()->key() == member->key())
      last.back() = member;
    else
      last.push_back(member);
  return last;
}

namespace {

/// What follows the mark: the library says "[json.exception.parse_error.101] parse error at line 3, column 7:
/// syntax error while ...".
std::string behind(std::string_view mark, const std::string& message) {
  const std::size_t begin = message.find(mark);
  return begin == std::string::npos ? message : message.substr(begin + mark.size());
}

Fault syntaxFault(std::string_view text, const Unordered::parse_error& error) {
  Fault fault;
  const std::size_t end = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
  fault.line = 1 + static_cast<int>(
                       std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
  const std::size_t lineStart = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  fault.column = static_cast<int>(end - (lineStart == std::string::npos ? 0 : lineStart + 1)) + 1;
  fault.message = behind(": ", error.what());
  return fault;
}

}  // namespace

/// Takes what the parser finds.
class JsonBuilder final : public Unordered::json_sax_t {
 public:
  JsonBuilder(std::string_view text, JsonDocument& out) : text_(text), out_(out) {
    // memory that is not used is not touched either
    constexpr std::size_t kCharactersPerValue = 8;
    out.values_.reserve(text.size() / kCharactersPerValue + 1);
  }

  std::vector<Fault> faults;
  bool stopped = false;  ///< by a fault that ends the reading

  bool null() override { return add(JsonValue::Type::Null), true; }
  bool boolean(bool value) override { return add(JsonValue::Type::Boolean).content_.whole = value, true; }
  bool number_integer(number_integer_t value) override {
    return add(JsonValue::Type::Negative).content_.negative = value, true;
  }
  bool number_unsigned(number_unsigned_t value) override {
    return add(JsonValue::Type::Whole).content_.whole = value, true;
  }
  bool number_float(number_float_t value, const string_t&) override {
    return add(JsonValue::Type::Real).content_.real = value, true;
  }
  bool string(string_t& value) override {
    JsonValue& added = add(JsonValue::Type::Text);
    added.content_.text = keep(value), added.size_ = static_cast<std::uint32_t>(value.size());
    return true;
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return begin(JsonValue::Type::Object); }
  bool start_array(std::size_t) override { return begin(JsonValue::Type::List); }
  bool key(string_t& key) override {
    key_ = keep(key), keySize_ = static_cast<std::uint32_t>(key.size());
    return true;
  }
  bool end_object() override {
    noteTwice(openValue());
    return end_array();
  }
  bool end_array() override {
    openValue().span_ = static_cast<std::uint32_t>(out_.values_.size() - open_.back());
    open_.pop_back();
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
    const auto* const syntax = dynamic_cast<const Unordered::parse_error*>(&error);
    return stop(syntax ? syntaxFault(text_, *syntax) : Fault{"", 0, 0, behind("] ", error.what())});
  }

 private:
  JsonValue& openValue() { return out_.values_[open_.back()]; }
  JsonValue& add(JsonValue::Type type) {
    if (!open_.empty()) ++openValue().size_;
    JsonValue& added = out_.values_.emplace_back();
    added.type_ = type;
    added.key_ = key_, added.keySize_ = keySize_;
    key_ = nullptr, keySize_ = 0;
    return added;
  }
  bool begin(JsonValue::Type type) {
    if (open_.size() == kMostJsonLevels) {
      if (!open_.empty()) ++openValue().size_;
      return stop({path() + place(openValue(), {key_, keySize_}, openValue().size_ - 1), 0, 0,
                   "expected at most " + std::to_string(kMostJsonLevels) +
                       " lists and objects within one another, got more"});
    }
    add(type);
    open_.push_back(out_.values_.size() - 1);
    return true;
  }
  bool stop(Fault fault) {
    stopped = true;
    faults = {std::move(fault)};
    return false;
  }
  /// A copy of a text that lives as long as the document.
  const char* keep(const std::string& text) {
    constexpr std::size_t kBlock = 1 << 16;
    if (text.size() > left_) {
      left_ = std::max(kBlock, text.size());
      next_ = out_.texts_.emplace_back(new char[left_]).get();
    }
    char* const own = next_;
    std::ranges::copy(text, own);
    next_ += text.size(), left_ -= text.size();
    return own;
  }
  /// Notes each key of an object that is there again.
  void noteTwice(const JsonValue& object) {
    // its span is not known yet
    members_.clear();
    const JsonValue* const end = out_.values_.data() + out_.values_.size();
    for (JsonValue::Iterator at(&object + 1); at != JsonValue::Iterator(end); ++at)
      members_.push_back((*at).key());
    constexpr std::size_t kFew = 12;
    if (members_.size() > kFew) {
      std::ranges::sort(members_);
      for (std::size_t k = 1; k < members_.size(); ++k)
        if (members_[k] == members_[k - 1]) noteTwice(members_[k]);
      return;
    }
    for (std::size_t k = 1; k < members_.size(); ++k)
      if (std::find(members_.begin(), members_.begin() + static_cast<std::ptrdiff_t>(k), members_[k]) !=
          members_.begin() + static_cast<std::ptrdiff_t>(k))
        noteTwice(members_[k]);
  }
  void noteTwice(std::string_view key) {
    faults.push_back({path() + place(openValue(), key, 0), 0, 0,
                      "expected each key once, got " + describe(key) + " again"});
  }
  static std::string separated(const std::string& path, std::string_view key) {
    return (path.empty() ? "" : ".") + std::string(key);
  }
  /// What a path says of a value inside another.
  std::string place(const JsonValue& outer, std::string_view key, std::size_t index) const {
    return outer.isList() ? "[" + std::to_string(index) + "]" : separated(path(), key);
  }
  /// Of the innermost open value.
  std::string path() const {
    std::string text;
    for (std::size_t level = 1; level < open_.size(); ++level) {
      const JsonValue &outer = out_.values_[open_[level - 1]], &inner = out_.values_[open_[level]];
      text += outer.isList() ? "[" + std::to_string(outer.size() - 1) + "]" : separated(text, inner.key());
    }
    return text;
  }

  std::string_view text_;
  JsonDocument& out_;
  std::vector<std::size_t> open_;  ///< places of lists and objects that have not ended
  std::vector<std::string_view> members_;
  const char* key_ = nullptr;
  std::uint32_t keySize_ = 0;
  char* next_ = nullptr;
  std::size_t left_ = 0;
};

std::optional<JsonDocument> parseJson(std::string_view text, std::vector<Fault>& faults) {
  JsonDocument document;
  JsonBuilder builder(text, document);
  Unordered::sax_parse(text, &builder);
  faults.insert(faults.end(), builder.faults.begin(), builder.faults.end());
  if (builder.stopped) return std::nullopt;
  return document;
}

std::string describe(std::string_view text) {
  constexpr std::size_t kShown = 40;
  return "\"" + (text.size() <= kShown ? std::string(text) : std::string(text.substr(0, kShown)) + "...") +
         "\"";
}

std::string describe(double number) { return Unordered(number).dump(); }

std::string describe(const JsonValue& value) {
  switch (value.type()) {
    case JsonValue::Type::Null:
      return "null";
    case JsonValue::Type::Boolean:
      return value.boolean() ? "true" : "false";
    case JsonValue::Type::Negative:
      return std::to_string(static_cast<std::int64_t>(value.whole()));
    case JsonValue::Type::Whole:
      return std::to_string(value.whole());
    case JsonValue::Type::Real:
      return describe(value.number());
    case JsonValue::Type::Text:
      return describe(value.text());
    case JsonValue::Type::List:
      return "a list of " + std::to_string(value.size());
    default:
      return "an object";
  }
}

}  // namespace rubble::io
