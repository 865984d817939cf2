/// USD layers as crate files (.usdc), versions 0.4 and later (OpenUSD, crateFile.cpp). The writer is
/// convert/out/usd_binary.cpp.
#include <bit>

#include "convert/usd/crate_tables.h"
#include "convert/usd/crate_types.h"

namespace rubble::usd {
namespace {

enum class Spec { Attribute = 1, Prim = 6, Root = 7, Relation = 8, Variant = 10, VariantSet = 11 };

class CrateParser : CrateTables {
 public:
  using CrateTables::CrateTables;

  Layer parse() {
    layer_.file = file_;
    readTables(), readSpecs();
    return std::move(layer_);
  }

 private:
  void readSpecs() {
    section("SPECS");
    const std::size_t n = tableSize();
    const auto paths = integers(n), sets = integers(n), types = integers(n);
    // prims in the order of their paths, so that parents come first
    std::map<std::size_t, std::pair<Spec, std::size_t>> specs;
    for (std::size_t i = 0; i < n; ++i) {
      const auto p = static_cast<std::size_t>(paths[i]);
      if (p >= paths_.size() || !paths_[p].isKnown) fail("the number of a path");
      specs[p] = {static_cast<Spec>(types[i]), static_cast<std::size_t>(sets[i])};
    }
    prims_[0] = &layer_.root;
    std::vector<std::size_t> order;
    for (const auto& [p, spec] : specs) order.push_back(p);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return paths_[a].text.size() < paths_[b].text.size();
    });
    for (const std::size_t p : order) addSpec(p, specs[p].first, specs[p].second);
    for (const std::size_t p : order)
      if (prims_.contains(p)) orderChildren(*prims_[p], childNames_[p]);
  }
  static void orderChildren(Prim& prim, const std::vector<std::string>& names) {
    std::map<std::string, std::size_t> at;
    for (std::size_t i = 0; i < names.size(); ++i) at.emplace(names[i], i);
    const auto place = [&](const std::unique_ptr<Prim>& each) {
      const auto found = at.find(each->name);
      return found == at.end() ? names.size() : found->second;
    };
    std::stable_sort(prim.children.begin(), prim.children.end(),
                     [&](const auto& a, const auto& b) { return place(a) < place(b); });
  }

  void addSpec(std::size_t p, Spec spec, std::size_t set) {
    const Path& own = paths_[p];
    const bool isRoot = own.text == "/";
    if (spec == Spec::Attribute || spec == Spec::Relation) {
      const auto above = prims_.find(own.parent);
      if (above == prims_.end()) return;
      Property property;
      property.name = own.name, property.file = file_;
      forEachField(set, [&](const std::string& name, std::uint64_t value) {
        if (name == "typeName") property.type = text(value);
        if (name == "default") property.value = decode(value);
        if (name == "timeSamples") property.isAnimated = true, addSample(value, property);
        if (name == "targetPaths" || name == "connectionPaths") property.targets = pathList(value);
      });
      above->second->properties.push_back(std::move(property));
      return;
    }
    Prim* prim = nullptr;
    if (isRoot) {
      prim = &layer_.root;
    } else if (spec == Spec::Variant || (spec == Spec::Prim && own.name.starts_with("{"))) {
      const auto above = prims_.find(own.parent);
      const std::size_t equals = own.name.find('=');
      if (above == prims_.end() || equals == std::string::npos) return;
      const std::string setName = own.name.substr(1, equals - 1),
                        choice = own.name.substr(equals + 1, own.name.size() - equals - 2);
      auto& place = above->second->variants[setName][choice];
      place = std::make_unique<Prim>();
      prim = place.get();
    } else if (spec == Spec::Prim) {
      const auto above = prims_.find(own.parent);
      if (above == prims_.end()) return;
      above->second->children.push_back(std::make_unique<Prim>());
      prim = above->second->children.back().get();
      prim->name = own.name;
    } else {
      return;
    }
    prim->file = file_;
    prims_[p] = prim;
    forEachField(set,
                 [&](const std::string& name, std::uint64_t value) { primField(*prim, p, name, value); });
  }
  template <class F> void forEachField(std::size_t set, F&& f) {
    for (std::size_t i = set; i < fieldSets_.size() && fieldSets_[i] >= 0; ++i) {
      const auto field = static_cast<std::size_t>(fieldSets_[i]);
      if (field >= fields_.size()) fail("the number of a field");
      f(token(fields_[field].token), fields_[field].value);
    }
  }

  void primField(Prim& prim, std::size_t p, const std::string& name, std::uint64_t value) {
    const auto number = [&] {
      const Value v = decode(value);
      return v.numbers.empty() ? 0. : v.numbers[0];
    };
    if (name == "typeName") prim.type = text(value);
    if (name == "specifier")
      prim.kind = (value & kPayload) == 0   ? Prim::Kind::Def
                  : (value & kPayload) == 1 ? Prim::Kind::Over
                                            : Prim::Kind::Class;
    if (name == "active") prim.active = number() != 0;
    if (name == "apiSchemas") prim.schemas = decode(value).texts;
    if (name == "primChildren") childNames_[p] = decode(value).texts;
    if (name == "references" || name == "payload") addArcs(value, prim.references);
    if (name == "inheritPaths" || name == "specializes")
      for (const std::string& target : pathList(value)) prim.inherits.push_back({"", target, 0});
    if (name == "variantSelection") {
      seek(value);
      const std::size_t n = count(8);
      for (std::size_t i = 0; i < n; ++i) {
        const std::string set = string(next<std::uint32_t>());
        prim.selections[set] = string(next<std::uint32_t>());
      }
    }
    if (&prim != &layer_.root) return;
    if (name == "defaultPrim") layer_.defaultPrim = text(value);
    if (name == "upAxis") layer_.upAxis = text(value);
    if (name == "metersPerUnit") layer_.metersPerUnit = number();
    if (name == "kilogramsPerUnit") layer_.kilogramsPerUnit = number();
    if (name == "subLayers") layer_.subLayers = decode(value).texts;
  }

  std::string text(std::uint64_t value) {
    const Value v = decode(value);
    return v.texts.empty() ? "" : v.texts[0];
  }
  static Type typeOf(std::uint64_t value) { return static_cast<Type>(value >> 48 & 0xff); }
  void seek(std::uint64_t value) { at_ = static_cast<std::size_t>(value & kPayload); }

  Value decode(std::uint64_t value) {
    const Type type = typeOf(value);
    Value out;
    if (value & kIsArray) {
      if ((value & kPayload) != 0 || (value & kIsInlined)) decodeArray(type, value, out);
      return out;
    }
    if (const auto layout = layoutOf(type)) {
      if (value & kIsInlined) return inlined(*layout, static_cast<std::uint32_t>(value & 0xffffffff));
      seek(value);
      scalars(*layout, 1, out.numbers);
      return out;
    }
    const std::uint64_t payload = value & kPayload;
    switch (type) {
      case Type::String:
        out.texts.push_back(string(payload));
        break;
      case Type::Token:
      case Type::Asset:
        out.texts.push_back(token(payload));
        break;
      case Type::TokenVector: {
        seek(value);
        const std::size_t n = count(4);
        for (std::size_t i = 0; i < n; ++i) out.texts.push_back(token(next<std::uint32_t>()));
        break;
      }
      case Type::StringVector: {
        seek(value);
        const std::size_t n = count(4);
        for (std::size_t i = 0; i < n; ++i) out.texts.push_back(string(next<std::uint32_t>()));
        break;
      }
      case Type::TokenListOp:
        seek(value);
        forEachListed([&] { return token(next<std::uint32_t>()); },
                      [&](const std::string& each) { out.texts.push_back(each); });
        break;
      default:
        break;
    }
    return out;
  }
  /// Numbers of one to four bytes, of vectors and of the diagonals of matrices.
  static Value inlined(const Layout& layout, std::uint32_t bits) {
    Value out;
    const auto byte = [&](std::size_t i) {
      return static_cast<double>(static_cast<std::int8_t>(bits >> (8 * i) & 0xff));
    };
    if (layout.isMatrix) {
      const std::size_t n = layout.count == 4 ? 2 : layout.count == 9 ? 3 : 4;
      out.numbers.assign(layout.count, 0);
      for (std::size_t i = 0; i < n; ++i) out.numbers[i * n + i] = byte(i);
    } else if (layout.count > 1) {
      for (std::size_t i = 0; i < layout.count; ++i) out.numbers.push_back(byte(i));
    } else if (layout.of == Layout::Of::Half) {
      out.numbers.push_back(halfToDouble(static_cast<std::uint16_t>(bits)));
    } else if (layout.of == Layout::Of::Float || layout.of == Layout::Of::Double) {
      out.numbers.push_back(static_cast<double>(std::bit_cast<float>(bits)));
    } else if (layout.of == Layout::Of::UInt || layout.of == Layout::Of::UInt64) {
      out.numbers.push_back(bits);
    } else {
      out.numbers.push_back(static_cast<std::int32_t>(bits));
    }
    return out;
  }

  void scalars(const Layout& layout, std::size_t n, std::vector<double>& out) {
    const std::size_t size = sizeOf(layout.of);
    if (n > kMostNumbers / layout.count ||
        n * layout.count > (bytes_.size() - std::min(at_, bytes_.size())) / size)
      fail("a number of elements that are there");
    const std::size_t first = out.size();
    out.reserve(first + n * layout.count);
    for (std::size_t i = 0; i < n * layout.count; ++i) out.push_back(scalar(layout.of));
    // quaternions have their scalar last
    for (std::size_t i = first; layout.isQuaternion && i + 3 < out.size(); i += 4)
      std::rotate(out.begin() + static_cast<std::ptrdiff_t>(i),
                  out.begin() + static_cast<std::ptrdiff_t>(i + 3),
                  out.begin() + static_cast<std::ptrdiff_t>(i + 4));
  }
  double scalar(Layout::Of of) {
    using Of = Layout::Of;
    switch (of) {
      case Of::Byte:
        return next<std::uint8_t>();
      case Of::Int:
        return next<std::int32_t>();
      case Of::UInt:
        return next<std::uint32_t>();
      case Of::Int64:
        return static_cast<double>(next<std::int64_t>());
      case Of::UInt64:
        return static_cast<double>(next<std::uint64_t>());
      case Of::Half:
        return halfToDouble(next<std::uint16_t>());
      case Of::Float:
        return static_cast<double>(next<float>());
      case Of::Double:
        break;
    }
    return next<double>();
  }

  void decodeArray(Type type, std::uint64_t value, Value& out) {
    seek(value);
    if (version_ < 500) next<std::uint32_t>();  // a rank, which is 1
    const std::uint64_t n = version_ < 700 ? next<std::uint32_t>() : next<std::uint64_t>();
    if (n > kMostNumbers) fail("a smaller array");
    const auto size = static_cast<std::size_t>(n);
    if (type == Type::Token || type == Type::String || type == Type::Asset) {
      if (size > (bytes_.size() - at_) / 4) fail("a number of elements that are there");
      for (std::size_t i = 0; i < size; ++i) {
        const auto each = next<std::uint32_t>();
        out.texts.push_back(type == Type::String ? string(each) : token(each));
      }
      return;
    }
    const auto layout = layoutOf(type);
    if (!layout) return;
    if (!(value & kIsCompressed) || n < kLeastCompressed) return scalars(*layout, size, out.numbers);
    using Of = Layout::Of;
    const bool wide = layout->of == Of::Int64 || layout->of == Of::UInt64;
    if (wide || layout->of == Of::Int || layout->of == Of::UInt) {
      for (const std::int64_t each : unpackIntegers(packed(), size, wide, where()))
        out.numbers.push_back(layout->of == Of::UInt ? static_cast<double>(static_cast<std::uint32_t>(each))
                                                     : static_cast<double>(each));
      return;
    }
    // floats that are whole numbers, or of which there are few
    const auto code = next<std::int8_t>();
    if (code == 'i') {
      for (const std::int64_t each : unpackIntegers(packed(), size, false, where()))
        out.numbers.push_back(static_cast<double>(each));
      return;
    }
    if (code != 't') fail("the code of an array");
    const std::size_t different = next<std::uint32_t>();
    std::vector<double> table;
    scalars(*layout, different, table);
    for (const std::int64_t each : unpackIntegers(packed(), size, false, where())) {
      if (each < 0 || static_cast<std::size_t>(each) >= table.size()) fail("the number of an element");
      out.numbers.push_back(table[static_cast<std::size_t>(each)]);
    }
  }

  /// The items of the edits of a list that add some.
  template <class Read, class Use> void forEachListed(Read&& item, Use&& use) {
    const auto flags = next<std::uint8_t>();
    for (int bit = 1; bit < 7; ++bit) {  // explicit, added, deleted, ordered, prepended, appended
      if (!(flags >> bit & 1)) continue;
      const std::size_t n = count(4);
      for (std::size_t i = 0; i < n; ++i) {
        auto each = item();
        if (bit != 3 && bit != 4) use(each);
      }
    }
  }
  std::vector<std::string> pathList(std::uint64_t value) {
    std::vector<std::string> out;
    seek(value);
    if (typeOf(value) == Type::PathListOp) {
      forEachListed([&] { return path(next<std::uint32_t>()); },
                    [&](const std::string& each) { out.push_back(each); });
    } else if (typeOf(value) == Type::PathVector) {
      const std::size_t n = count(4);
      for (std::size_t i = 0; i < n; ++i) out.push_back(path(next<std::uint32_t>()));
    }
    return out;
  }
  Arc arc(bool isReference) {
    Arc out;
    out.asset = string(next<std::uint32_t>());
    const auto target = next<std::uint32_t>();
    // no path: the empty one, which no spec has
    out.path = target < paths_.size() && paths_[target].isKnown && paths_[target].text != "/" ? path(target)
                                                                                              : "";
    if (isReference || version_ >= 800) next<double>(), next<double>();  // an offset in time
    if (isReference) skipDictionary(0);
    return out;
  }
  void addArcs(std::uint64_t value, std::vector<Arc>& arcs) {
    seek(value);
    const Type type = typeOf(value);
    const auto add = [&](const Arc& each) { arcs.push_back(each); };
    if (type == Type::Payload)
      add(arc(false));
    else if (type == Type::PayloadListOp || type == Type::ReferenceListOp)
      forEachListed([&] { return arc(type == Type::ReferenceListOp); }, add);
  }
  void skipDictionary(int depth) {
    if (depth > kMostDepth) fail("at most 100 levels of values");
    const std::size_t n = count(12);
    for (std::size_t i = 0; i < n; ++i) {
      next<std::uint32_t>();
      skipNested();
      next<std::uint64_t>();
    }
  }
  /// What stands before a value, behind the distance to it.
  void skipNested() {
    const std::size_t from = at_;
    const auto distance = next<std::int64_t>();
    if (distance < 8 || static_cast<std::uint64_t>(distance) > bytes_.size() - from) fail("a distance");
    at_ = from + static_cast<std::size_t>(distance);
  }
  void addSample(std::uint64_t value, Property& property) {
    seek(value);
    skipNested();
    next<std::uint64_t>();
    skipNested();
    const std::size_t n = count(8);
    if (n > 0 && property.value.empty()) property.value = decode(next<std::uint64_t>());
  }

  Layer layer_;
  std::map<std::size_t, Prim*> prims_;
  std::map<std::size_t, std::vector<std::string>> childNames_;
};

}  // namespace

Layer parseCrate(const std::string& bytes, const std::string& file) {
  return CrateParser(bytes, file).parse();
}

}  // namespace rubble::usd
