/// USD layers as text (.usda).
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include <rubble/error.h>

#include "convert/usd/layer.h"

namespace rubble::usd {
namespace {

struct Token {
  enum class Kind { Word, Number, Text, Asset, Path, Sign, End };
  Kind kind = Kind::End;
  std::string text;
  double number = 0;
  int line = 1;

  bool is(const char* sign) const { return kind != Kind::Text && kind != Kind::Asset && text == sign; }
};

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& file) : text_(text), file_(file) { next_ = scan(); }

  const Token& peek() const { return next_; }
  Token take() {
    Token out = std::move(next_);
    next_ = scan();
    return out;
  }
  bool skip(const char* sign) {
    if (!next_.is(sign)) return false;
    take();
    return true;
  }
  void need(const char* sign) {
    if (!skip(sign)) fail(std::string("\"") + sign + "\"");
  }
  Token need(Token::Kind kind, const char* what) {
    if (next_.kind != kind) fail(what);
    return take();
  }
  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(file_ + ":" + std::to_string(next_.line), expected,
                next_.kind == Token::Kind::End ? "the end" : "\"" + next_.text.substr(0, 40) + "\"");
  }
  const std::string& file() const { return file_; }

 private:
  static bool isWord(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80;
  }
  char at(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }

  Token scan() {
    for (;;) {
      while (at_ < text_.size() &&
             (at() == ' ' || at() == '\t' || at() == '\r' || at() == '\n' || at() == ';')) {
        line_ += at() == '\n';
        ++at_;
      }
      if (at() != '#') break;
      while (at_ < text_.size() && at() != '\n') ++at_;
    }
    Token out;
    out.line = line_;
    if (at_ >= text_.size()) return out;
    const char c = at();
    if (c == '"' || c == '\'') return quoted(out, c);
    if (c == '@') return asset(out);
    if (c == '<') {
      const std::size_t end = text_.find('>', at_);
      if (end == std::string_view::npos) error(">");
      out.kind = Token::Kind::Path, out.text = text_.substr(at_ + 1, end - at_ - 1);
      at_ = end + 1;
      return out;
    }
    const bool digit = c >= '0' && c <= '9';
    const bool signedNumber = (c == '-' || c == '+' || c == '.') &&
                              ((at(1) >= '0' && at(1) <= '9') || at(1) == '.' || at(1) == 'i');
    if (digit || signedNumber) return number(out);
    if (isWord(c)) {
      std::size_t size = 0;
      while (isWord(at(size)) || ((at(size) == ':' || at(size) == '.') && isWord(at(size + 1)))) ++size;
      out.kind = Token::Kind::Word, out.text = text_.substr(at_, size);
      at_ += size;
      return out;
    }
    out.kind = Token::Kind::Sign, out.text = c;
    ++at_;
    return out;
  }
  Token quoted(Token out, char quote) {
    out.kind = Token::Kind::Text;
    const bool triple = at(1) == quote && at(2) == quote;
    at_ += triple ? 3 : 1;
    for (;;) {
      if (at_ >= text_.size()) error("the end of a text");
      const char c = at();
      if (c == quote && (!triple || (at(1) == quote && at(2) == quote))) break;
      if (c == '\n' && !triple) error("the end of a text");
      line_ += c == '\n';
      if (c == '\\' && at_ + 1 < text_.size()) {
        ++at_;
        out.text += at() == 'n' ? '\n' : at() == 't' ? '\t' : at();
      } else {
        out.text += c;
      }
      ++at_;
    }
    at_ += triple ? 3 : 1;
    return out;
  }
  Token asset(Token out) {
    out.kind = Token::Kind::Asset;
    const std::string_view mark = text_.substr(at_, 3) == "@@@" ? "@@@" : "@";
    const std::size_t begin = at_ + mark.size(), end = text_.find(mark, begin);
    if (end == std::string_view::npos) error("@");
    out.text = text_.substr(begin, end - begin);
    at_ = end + mark.size();
    return out;
  }
  Token number(Token out) {
    out.kind = Token::Kind::Number;
    const std::size_t sign = at() == '-' || at() == '+';
    if (text_.substr(at_ + sign, 3) == "inf") {
      out.number = std::numeric_limits<double>::infinity() * (at() == '-' ? -1 : 1);
      out.text = text_.substr(at_, sign + 3);
      at_ += sign + 3;
      return out;
    }
    const char* const begin = text_.data() + at_ + (at() == '+');
    const auto [end, failed] = std::from_chars(begin, text_.data() + text_.size(), out.number);
    if (failed == std::errc::result_out_of_range)
      out.number = at() == '-' ? -std::numeric_limits<double>::max() : std::numeric_limits<double>::max();
    else if (failed != std::errc())
      error("a number");
    const auto next = static_cast<std::size_t>(end - text_.data());
    out.text = text_.substr(at_, next - at_);
    at_ = next;
    return out;
  }
  [[noreturn]] void error(const char* expected) const {
    throw Error(file_ + ":" + std::to_string(line_), expected, "other text");
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  int line_ = 1;
  Token next_;
};

/// What a value may hold besides numbers and texts: paths with assets.
struct Parsed {
  Value value;
  std::vector<Arc> arcs;
};

class TextParser {
 public:
  TextParser(const std::string& text, const std::string& file) : scan_(text, file) { layer_.file = file; }

  Layer parse() {
    layer_.root.kind = Prim::Kind::Def;
    if (scan_.skip("(")) layerMetadata();
    while (scan_.peek().kind != Token::Kind::End) {
      if (isPrim())
        addPrim(layer_.root, 0);
      else if (scan_.skip("reorder"))
        scan_.take(), scan_.need("="), value(0);
      else
        scan_.fail("def, over or class");
    }
    return std::move(layer_);
  }

 private:
  bool isPrim() const {
    const Token& t = scan_.peek();
    return t.is("def") || t.is("over") || t.is("class");
  }

  void layerMetadata() {
    while (!scan_.skip(")")) {
      if (scan_.peek().kind == Token::Kind::Text) {
        scan_.take();
        continue;
      }
      const std::string key = entryKey();
      const Parsed found = value(0);
      const Value& v = found.value;
      if (key == "defaultPrim" && !v.texts.empty()) layer_.defaultPrim = v.texts[0];
      if (key == "upAxis" && !v.texts.empty()) layer_.upAxis = v.texts[0];
      if (key == "metersPerUnit" && !v.numbers.empty()) layer_.metersPerUnit = v.numbers[0];
      if (key == "kilogramsPerUnit" && !v.numbers.empty()) layer_.kilogramsPerUnit = v.numbers[0];
      if (key == "subLayers")
        for (const Arc& arc : found.arcs) layer_.subLayers.push_back(arc.asset);
    }
  }
  /// The key of an entry of metadata, up to its "=". Edits of lists are taken as the lists.
  std::string entryKey() {
    isDeleted_ = false;
    std::string key = scan_.need(Token::Kind::Word, "a key").text;
    if (key == "prepend" || key == "append" || key == "add" || key == "delete" || key == "reorder") {
      isDeleted_ = key == "delete" || key == "reorder";
      key = scan_.need(Token::Kind::Word, "a key").text;
    }
    scan_.need("=");
    return key;
  }

  void addPrim(Prim& parent, int depth) {
    if (depth > kMostDepth) scan_.fail("at most 100 levels of prims");
    if (++prims_ > kMostPrims) scan_.fail("at most 500000 prims");
    const Token specifier = scan_.take();
    auto prim = std::make_unique<Prim>();
    prim->kind = specifier.is("def")    ? Prim::Kind::Def
                 : specifier.is("over") ? Prim::Kind::Over
                                        : Prim::Kind::Class;
    prim->line = specifier.line, prim->file = scan_.file();
    if (scan_.peek().kind == Token::Kind::Word) prim->type = scan_.take().text;
    prim->name = scan_.need(Token::Kind::Text, "the name of a prim").text;
    if (prim->name.empty() || prim->name.find('/') != std::string::npos) scan_.fail("the name of a prim");
    if (scan_.skip("(")) primMetadata(*prim);
    scan_.need("{");
    content(*prim, depth + 1);
    if (parent.child(prim->name)) scan_.fail("a name that no other prim beside it has");
    parent.children.push_back(std::move(prim));
  }

  void primMetadata(Prim& prim) {
    while (!scan_.skip(")")) {
      if (scan_.peek().kind == Token::Kind::Text) {
        scan_.take();
        continue;
      }
      if (scan_.peek().kind == Token::Kind::End) scan_.fail(")");
      const int line = scan_.peek().line;
      const std::string key = entryKey();
      if (key == "variants") {
        selections(prim);
        continue;
      }
      Parsed found = value(0);
      if (isDeleted_) continue;
      for (Arc& arc : found.arcs) arc.line = line;
      if (key == "active" && !found.value.numbers.empty()) prim.active = found.value.numbers[0] != 0;
      if (key == "apiSchemas")
        prim.schemas.insert(prim.schemas.end(), found.value.texts.begin(), found.value.texts.end());
      auto& arcs = key == "references" || key == "payload" ? prim.references : prim.inherits;
      if (key == "references" || key == "payload" || key == "inherits" || key == "specializes")
        arcs.insert(arcs.end(), found.arcs.begin(), found.arcs.end());
    }
  }
  void selections(Prim& prim) {
    scan_.need("{");
    while (!scan_.skip("}")) {
      scan_.need(Token::Kind::Word, "string");
      const std::string set = scan_.take().text;
      scan_.need("=");
      prim.selections[set] = scan_.need(Token::Kind::Text, "the name of a variant").text;
      scan_.skip(",");
    }
  }

  void content(Prim& prim, int depth) {
    while (!scan_.skip("}")) {
      if (scan_.peek().kind == Token::Kind::End) scan_.fail("}");
      if (isPrim())
        addPrim(prim, depth);
      else if (scan_.skip("variantSet"))
        variantSet(prim, depth);
      else if (scan_.skip("reorder"))
        scan_.take(), scan_.need("="), value(0);
      else
        property(prim);
    }
  }
  void variantSet(Prim& prim, int depth) {
    if (depth > kMostDepth) scan_.fail("at most 100 levels of prims");
    const std::string set = scan_.need(Token::Kind::Text, "the name of a set of variants").text;
    scan_.need("="), scan_.need("{");
    while (!scan_.skip("}")) {
      const Token name = scan_.need(Token::Kind::Text, "the name of a variant");
      auto variant = std::make_unique<Prim>();
      variant->line = name.line, variant->file = scan_.file();
      if (scan_.skip("(")) primMetadata(*variant);
      scan_.need("{");
      content(*variant, depth + 1);
      prim.variants[set][name.text] = std::move(variant);
    }
  }

  void property(Prim& prim) {
    bool deletes = false;
    for (const char* edit : {"prepend", "append", "add", "delete"})
      if (scan_.skip(edit)) deletes = std::string_view(edit) == "delete";
    while (scan_.peek().is("custom") || scan_.peek().is("uniform") || scan_.peek().is("varying") ||
           scan_.peek().is("config"))
      scan_.take();
    Property found;
    found.line = scan_.peek().line, found.file = scan_.file();
    const std::string type = scan_.need(Token::Kind::Word, "a property").text;
    if (type != "rel") found.type = type;
    if (scan_.skip("[")) scan_.need("]"), found.type += "[]";
    found.name = scan_.need(Token::Kind::Word, "the name of a property").text;
    bool samples = false, connects = false;
    for (const auto& [ending, flag] : {std::pair{".timeSamples", &samples}, {".connect", &connects}})
      if (found.name.ends_with(ending))
        *flag = true, found.name.resize(found.name.size() - std::string_view(ending).size());
    if (scan_.skip("=")) {
      if (samples) {
        found.value = inType(found.type, firstSample());
        found.isAnimated = true;
      } else {
        Parsed parsed = value(0);
        if (type == "rel" || connects)
          for (const Arc& arc : parsed.arcs) found.targets.push_back(arc.path);
        else
          found.value = inType(found.type, std::move(parsed.value));
      }
    }
    if (scan_.skip("(")) skipMetadata();
    if (deletes) return;
    for (Property& own : prim.properties)
      if (own.name == found.name) {
        if (!found.targets.empty()) own.targets = std::move(found.targets);
        if (own.value.empty()) own.value = std::move(found.value);
        own.isAnimated = own.isAnimated || found.isAnimated;
        return;
      }
    prim.properties.push_back(std::move(found));
  }
  /// Numbers of types of single precision are what a crate file holds of them.
  static Value inType(std::string type, Value value) {
    if (type.ends_with("[]")) type.resize(type.size() - 2);
    const bool isSingle = type.starts_with("float") || (type.ends_with('f') && type != "half");
    for (double& number : value.numbers)
      if (isSingle && std::fabs(number) < kLargestSingle)
        number = static_cast<double>(static_cast<float>(number));
    return value;
  }
  static constexpr double kLargestSingle = 3e38;
  void skipMetadata() {
    while (!scan_.skip(")")) {
      if (scan_.peek().kind == Token::Kind::Text) {
        scan_.take();
        continue;
      }
      entryKey();
      value(0);
    }
  }
  Value firstSample() {
    scan_.need("{");
    Value out;
    for (bool first = true; !scan_.skip("}"); first = false) {
      scan_.need(Token::Kind::Number, "a time");
      scan_.need(":");
      Parsed found = value(0);
      if (first) out = std::move(found.value);
      scan_.skip(",");
    }
    return out;
  }

  Parsed value(int depth) {
    Parsed out;
    addValue(out, depth);
    return out;
  }
  void addValue(Parsed& out, int depth) {
    if (depth > kMostDepth) scan_.fail("at most 100 levels of values");
    const Token& next = scan_.peek();
    switch (next.kind) {
      case Token::Kind::Number:
        out.value.numbers.push_back(scan_.take().number);
        return;
      case Token::Kind::Text:
        out.value.texts.push_back(scan_.take().text);
        return;
      case Token::Kind::Asset: {
        Arc arc;
        arc.asset = scan_.take().text;
        out.value.texts.push_back(arc.asset);
        if (scan_.peek().kind == Token::Kind::Path) arc.path = scan_.take().text;
        out.arcs.push_back(arc);
        if (scan_.skip("(")) skipMetadata();  // an offset in time
        return;
      }
      case Token::Kind::Path:
        out.arcs.push_back({"", scan_.take().text, 0});
        if (scan_.skip("(")) skipMetadata();
        return;
      case Token::Kind::Word: {
        const std::string word = scan_.take().text;
        if (word == "true" || word == "false")
          out.value.numbers.push_back(word == "true");
        else if (word == "inf" || word == "nan")
          out.value.numbers.push_back(std::numeric_limits<double>::infinity());
        else if (word != "None")
          out.value.texts.push_back(word);
        return;
      }
      case Token::Kind::Sign:
        if (next.is("(") || next.is("[")) {
          const char* const end = next.is("(") ? ")" : "]";
          scan_.take();
          while (!scan_.skip(end)) {
            addValue(out, depth + 1);
            if (!scan_.skip(",") && !scan_.peek().is(end)) scan_.fail(end);
          }
          return;
        }
        if (next.is("{")) return skipDictionary(depth);
        break;
      case Token::Kind::End:
        break;
    }
    scan_.fail("a value");
  }
  void skipDictionary(int depth) {
    if (depth > kMostDepth) scan_.fail("at most 100 levels of values");
    scan_.need("{");
    while (!scan_.skip("}")) {
      if (scan_.peek().kind == Token::Kind::Number) {  // time samples
        scan_.take(), scan_.need(":");
      } else {
        scan_.need(Token::Kind::Word, "a type");
        if (scan_.skip("[")) scan_.need("]");
        if (!scan_.peek().is("=")) scan_.take();
        scan_.need("=");
      }
      value(depth + 1);
      scan_.skip(",");
    }
  }

  Scanner scan_;
  Layer layer_;
  std::size_t prims_ = 0;
  bool isDeleted_ = false;
};

}  // namespace

Layer parseText(const std::string& text, const std::string& file) {
  if (!text.starts_with("#usda")) throw Error(file, "a USD file", "other text");
  return TextParser(text, file).parse();
}

}  // namespace rubble::usd
