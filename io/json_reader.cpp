#include "io/json_reader.h"

#include <algorithm>
#include <cmath>

#include "cook/names.h"

namespace rubble::io {
namespace {

std::string inQuotes(const std::string& text) {
  constexpr std::size_t kShown = 40;
  return "\"" + (text.size() <= kShown ? text : text.substr(0, kShown) + "...") + "\"";
}

/// What follows the mark: the library says "[json.exception.parse_error.101] parse error at line 3, column 7:
/// syntax error while ...".
std::string behind(const std::string& mark, const std::string& message) {
  const std::size_t begin = message.find(mark);
  return begin == std::string::npos ? message : message.substr(begin + mark.size());
}

Fault syntaxFault(const std::string& text, const Json::parse_error& error) {
  Fault fault;
  const std::size_t end = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
  fault.line = 1 + static_cast<int>(
                       std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
  const std::size_t lineStart = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  fault.column = static_cast<int>(end - (lineStart == std::string::npos ? 0 : lineStart + 1)) + 1;
  fault.message = behind(": ", error.what());
  return fault;
}

/// Lists and objects within one another: no file needs more, and what reads one calls itself for each.
constexpr std::size_t kMostLevels = 64;

/// Goes through a text and notes keys that appear twice in one object, of which a parsed object has only the
/// last, and where it goes too deep. It leaves syntax to the parser.
class StructureCheck final : public Json::json_sax_t {
 public:
  std::vector<Fault> faults;
  bool tooDeep = false;

  bool null() override { return element(); }
  bool boolean(bool) override { return element(); }
  bool number_integer(number_integer_t) override { return element(); }
  bool number_unsigned(number_unsigned_t) override { return element(); }
  bool number_float(number_float_t, const string_t&) override { return element(); }
  bool string(string_t&) override { return element(); }
  bool binary(binary_t&) override { return element(); }
  bool start_object(std::size_t) override { return begin(false); }
  bool start_array(std::size_t) override { return begin(true); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool key(string_t& key) override {
    Level& level = levels_.back();
    level.key = key;
    if (!level.keys.insert(key).second)
      faults.push_back({path(), 0, 0, "expected each key once, got " + inQuotes(key) + " again"});
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  struct Level {
    bool isArray;
    int index;
    std::string key;
    std::set<std::string> keys;
  };

  bool element() {
    if (!levels_.empty() && levels_.back().isArray) ++levels_.back().index;
    return true;
  }
  bool begin(bool isArray) {
    element();
    if (levels_.size() == kMostLevels) {
      tooDeep = true;
      faults.push_back({path(), 0, 0,
                        "expected at most " + std::to_string(kMostLevels) +
                            " lists and objects within one another, got more"});
      return false;
    }
    levels_.push_back({isArray, -1, "", {}});
    return true;
  }
  bool end() {
    levels_.pop_back();
    return true;
  }
  std::string path() const {
    std::string text;
    for (const Level& level : levels_)
      text += level.isArray ? "[" + std::to_string(level.index) + "]" : (text.empty() ? "" : ".") + level.key;
    return text;
  }

  std::vector<Level> levels_;
};

}  // namespace

std::string Fault::text() const {
  if (line > 0) return "line " + std::to_string(line) + ", column " + std::to_string(column) + ": " + message;
  return path.empty() ? message : path + ": " + message;
}

std::string describe(const Json& value) {
  if (value.is_array()) return "a list of " + std::to_string(value.size());
  if (value.is_object()) return "an object";
  if (value.is_string()) return inQuotes(value.get_ref<const std::string&>());
  return value.dump();
}

std::string hint(const std::string& name, const std::vector<std::string>& names) {
  const std::string* best = nullptr;
  std::size_t bestDistance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : names) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance < bestDistance) best = &candidate, bestDistance = distance;
  }
  return best ? " (did you mean " + inQuotes(*best) + "?)" : "";
}

void Node::fault(const std::string& expected) const {
  faultText("expected " + expected + ", got " + describe(*value_));
}

void Node::faultText(const std::string& message) const { faults_->push_back({path_, 0, 0, message}); }

Node Node::child(const std::string& key) const {
  return {value_->at(key), path_.empty() ? key : path_ + "." + key, *faults_};
}

std::vector<Node> Node::elements(const char* what) const {
  std::vector<Node> nodes;
  if (!value_->is_array()) {
    fault(what);
    return nodes;
  }
  nodes.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i)
    nodes.emplace_back((*value_)[i], path_ + "[" + std::to_string(i) + "]", *faults_);
  return nodes;
}

std::optional<double> Node::number(const Want& want) const {
  if (value_->is_number()) {
    const double number = value_->get<double>();
    const bool aboveMin = want.minIncluded ? number >= want.min : number > want.min;
    if (std::isfinite(number) && aboveMin && number <= want.max) return number;
  }
  fault(want.text);
  return std::nullopt;
}

std::optional<int> Node::whole(int min, const char* text) const {
  if (value_->is_number_integer()) {
    const double number = value_->get<double>();
    if (number >= min && number <= std::numeric_limits<int>::max()) return static_cast<int>(number);
  }
  fault(text);
  return std::nullopt;
}

std::optional<std::string> Node::text() const {
  if (value_->is_string()) return value_->get<std::string>();
  fault("a text");
  return std::nullopt;
}

std::optional<bool> Node::boolean() const {
  if (value_->is_boolean()) return value_->get<bool>();
  fault("true or false");
  return std::nullopt;
}

std::optional<Vec3> Node::vector(const Want& each, const char* text) const {
  if (!value_->is_array() || value_->size() != 3) {
    fault(text);
    return std::nullopt;
  }
  Vec3 out;
  bool good = true;
  const std::vector<Node> parts = elements(text);
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> part = parts[static_cast<std::size_t>(i)].number(each);
    good = good && part;
    out[i] = part.value_or(0);
  }
  return good ? std::optional(out) : std::nullopt;
}

std::optional<std::size_t> Node::choice(const std::vector<std::string>& names) const {
  std::string wanted;
  for (const std::string& name : names) wanted += (wanted.empty() ? "" : ", ") + inQuotes(name);
  if (!value_->is_string()) {
    fault("one of " + wanted);
    return std::nullopt;
  }
  const auto found = std::find(names.begin(), names.end(), value_->get<std::string>());
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  faultText("expected one of " + wanted + ", got " + describe(*value_) +
            hint(value_->get<std::string>(), names));
  return std::nullopt;
}

ObjectReader::ObjectReader(const Node& node, const char* what)
    : node_(node), isObject_(node.value().is_object()) {
  if (!isObject_) node_.fault(what);
}

std::optional<Node> ObjectReader::get(const std::string& key) {
  known_.insert(key);
  if (!isObject_ || !node_.value().contains(key)) return std::nullopt;
  return node_.child(key);
}

std::optional<Node> ObjectReader::need(const std::string& key, const std::string& what) {
  std::optional<Node> found = get(key);
  if (!found && isObject_) node_.faultText("expected \"" + key + "\", " + what + ", got none");
  return found;
}

void ObjectReader::finish() {
  if (!isObject_) return;
  const std::vector<std::string> known(known_.begin(), known_.end());
  for (const auto& item : node_.value().items()) {
    if (known_.contains(item.key())) continue;
    const std::string near = hint(item.key(), known);
    std::string all;
    for (const std::string& key : known) all += (all.empty() ? "" : ", ") + key;
    node_.child(item.key()).faultText("unknown key" + (near.empty() ? "; known here: " + all : near));
  }
}

void ObjectReader::read(const std::string& key, double& out, const Want& want) {
  if (const auto node = get(key)) out = node->number(want).value_or(out);
}
void ObjectReader::read(const std::string& key, std::string& out) {
  if (const auto node = get(key)) out = node->text().value_or(out);
}
void ObjectReader::read(const std::string& key, bool& out) {
  if (const auto node = get(key)) out = node->boolean().value_or(out);
}
void ObjectReader::read(const std::string& key, std::uint64_t& out) {
  const auto node = get(key);
  if (!node) return;
  if (node->value().is_number_unsigned())
    out = node->value().get<std::uint64_t>();
  else
    node->fault("a whole number from 0 to 2^64 - 1");
}
void ObjectReader::read(const std::string& key, Vec3& out) {
  if (const auto node = get(key)) out = node->vector().value_or(out);
}

std::optional<Json> parseJson(const std::string& text, std::vector<Fault>& faults) {
  try {
    StructureCheck check;
    Json::sax_parse(text, &check);
    if (check.tooDeep) {
      faults.push_back(check.faults.back());
      return std::nullopt;
    }
    Json json = Json::parse(text);
    faults.insert(faults.end(), check.faults.begin(), check.faults.end());
    return json;
  } catch (const Json::parse_error& error) {
    faults.push_back(syntaxFault(text, error));
  } catch (const Json::out_of_range& error) {
    faults.push_back({"", 0, 0, behind("] ", error.what())});
  }
  return std::nullopt;
}

}  // namespace rubble::io
