/// USD layers as crate files (.usdc) of version 0.8.0 (OpenUSD, crateFile.cpp). A crate has values anywhere,
/// and tables of tokens, fields, paths and specs at its end, so frames are written as they come. The tables
/// are written in the compressed form without being compressed: values are what takes room.
#include <algorithm>
#include <bit>
#include <cstring>
#include <map>

#include "convert/out/usd_layer.h"
#include "io/output_file.h"
#include "platform/drop_behind.h"

namespace rubble::convert {
namespace {

static_assert(std::endian::native == std::endian::little, "crate files have the low byte first");

/// Numbers of the types of values.
enum Type : std::uint64_t {
  kBool = 1,
  kInt = 3,
  kInt64 = 5,
  kFloat32 = 8,
  kDouble = 9,
  kString = 10,
  kToken = 11,
  kMatrix4 = 15,
  kQuatf = 17,
  kQuath = 18,
  kVec2f = 20,
  kVec3f = 24,
  kPathListOp = 34,
  kTokenVector = 41,
  kSpecifier = 42,
  kVariability = 44,
  kTimeSamples = 46,
  kDoubleVector = 48
};
constexpr std::uint64_t kIsArray = 1ull << 63, kIsInlined = 1ull << 62;
constexpr int kTypeShift = 48;

/// Numbers of the kinds of specs.
enum SpecType : std::int32_t { kAttributeSpec = 1, kPrimSpec = 6, kPseudoRootSpec = 7, kRelationSpec = 8 };

constexpr std::uint64_t typed(Type type, std::uint64_t payload) {
  return static_cast<std::uint64_t>(type) << kTypeShift | payload;
}
constexpr std::uint64_t inlined(Type type, std::uint32_t payload) {
  return typed(type, payload) | kIsInlined;
}

template <class T> constexpr Type typeOf() {
  if constexpr (std::is_same_v<T, Vec3f>) return kVec3f;
  if constexpr (std::is_same_v<T, Quat4f>) return kQuatf;
  if constexpr (std::is_same_v<T, Quat4h>) return kQuath;
  if constexpr (std::is_same_v<T, int>) return kInt;
  if constexpr (std::is_same_v<T, std::int64_t>) return kInt64;
  if constexpr (std::is_same_v<T, float>) return kFloat32;
  return kToken;
}

using Bytes = std::vector<std::uint8_t>;

template <class T> void append(Bytes& out, const T* values, std::size_t count) {
  const std::size_t before = out.size();
  out.resize(before + count * sizeof(T));
  if (count > 0) std::memcpy(out.data() + before, values, count * sizeof(T));
}

/// One chunk that holds an LZ4 block of literals alone.
Bytes packBytes(const Bytes& content) {
  constexpr std::uint8_t kOneChunk = 0, kMore = 255;
  constexpr std::size_t kShort = 15;
  Bytes out{kOneChunk};
  std::size_t count = content.size();
  out.push_back(static_cast<std::uint8_t>(std::min(count, kShort) << 4));
  if (count >= kShort) {
    for (count -= kShort; count >= kMore; count -= kMore) out.push_back(kMore);
    out.push_back(static_cast<std::uint8_t>(count));
  }
  append(out, content.data(), content.size());
  return out;
}

/// Differences of integers, behind the most common one and two bits for the width of each: here all 32 bits.
Bytes packIntegers(const std::vector<std::int32_t>& values) {
  constexpr std::uint8_t kAllWide = 255;
  constexpr std::size_t kInByte = 4;
  Bytes content(sizeof(std::int32_t) + (values.size() + kInByte - 1) / kInByte, kAllWide);
  std::fill_n(content.begin(), sizeof(std::int32_t), std::uint8_t{0});
  std::uint32_t before = 0;
  for (const std::int32_t value : values) {
    const std::uint32_t difference = static_cast<std::uint32_t>(value) - before;
    append(content, &difference, 1);
    before = static_cast<std::uint32_t>(value);
  }
  return packBytes(content);
}

class BinaryLayer final : public UsdLayer {
 public:
  explicit BinaryLayer(const std::string& file) : out_(file), behind_(out_.path()) {
    const Head empty{};
    put(&empty, sizeof empty);
    token("");  // number 0 has no sign, so no property may have it
  }

  void set(int attribute, const UsdValue& value) override { defaults_[attribute] = valueOf(value); }

  void sample(int attribute, double time, const UsdValue& value) override {
    Samples& samples = samples_[attribute];
    samples.times.push_back(time);
    samples.values.push_back(valueOf(value));
  }

  void finish(const UsdHead& head) override {
    addRoot(head);
    for (const int prim : top_) addPrim(prim, 0);
    const std::uint64_t contents = writeTables();
    Head start{};
    std::memcpy(start.ident, "PXR-USDC", sizeof start.ident);
    start.version[1] = 8;
    start.contents = static_cast<std::int64_t>(contents);
    out_.stream().seekp(0);
    put(&start, sizeof start);
    out_.finish();
  }

 private:
  struct Head {
    char ident[8];
    std::uint8_t version[8];
    std::int64_t contents;
    std::int64_t reserved[8];
  };
  struct Path {
    std::int32_t token;
    bool isProperty;
    std::vector<std::int32_t> children;
  };
  struct Samples {
    std::vector<double> times;
    std::vector<std::uint64_t> values;
  };
  struct Section {
    char name[16];
    std::int64_t start, size;
  };

  void put(const void* data, std::size_t bytes) {
    out_.stream().write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
    at_ += bytes;
    behind_.written(at_);
  }
  template <class T> void put(const T& value) { put(&value, sizeof value); }
  template <class T> void putList(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    put(values.data(), values.size() * sizeof(T));
  }
  void align() {
    constexpr char kZeros[8] = {};
    put(kZeros, (8 - at_ % 8) % 8);
  }

  std::uint32_t token(const std::string& text) {
    const auto [at, isNew] = tokenNumbers_.try_emplace(text, static_cast<std::uint32_t>(tokens_.size()));
    if (isNew) tokens_.push_back(text);
    return at->second;
  }

  std::uint64_t valueOf(const UsdValue& value) {
    return std::visit([&](const auto& v) { return encode(v); }, value);
  }
  std::uint64_t encode(bool value) { return inlined(kBool, value); }
  std::uint64_t encode(float value) { return inlined(kFloat32, std::bit_cast<std::uint32_t>(value)); }
  std::uint64_t encode(const Token& value) { return inlined(kToken, token(value.text)); }
  std::uint64_t encode(double value) { return encodeAt(kDouble, value); }
  std::uint64_t encode(const std::array<float, 2>& value) { return encodeAt(kVec2f, value); }
  std::uint64_t encode(const Matrix4& value) { return encodeAt(kMatrix4, value); }
  template <class T> std::uint64_t encodeAt(Type type, const T& value) {
    align();
    const std::uint64_t start = at_;
    put(value);
    return typed(type, start);
  }
  std::uint64_t encode(std::span<const Token> values) {
    std::vector<std::uint32_t> numbers;
    for (const Token& t : values) numbers.push_back(token(t.text));
    return encodeArray(kToken, std::span<const std::uint32_t>(numbers));
  }
  template <class T> std::uint64_t encode(std::span<const T> values) {
    return encodeArray(typeOf<T>(), values);
  }
  template <class T> std::uint64_t encodeArray(Type type, std::span<const T> values) {
    if (values.empty()) return typed(type, 0) | kIsArray;
    align();
    const std::uint64_t start = at_;
    put(static_cast<std::uint64_t>(values.size()));
    put(values.data(), values.size_bytes());
    return typed(type, start) | kIsArray;
  }
  std::uint64_t encodeTokens(const std::vector<std::string>& texts) {
    std::vector<std::uint32_t> numbers;
    for (const std::string& text : texts) numbers.push_back(token(text));
    const std::uint64_t start = at_;
    putList(numbers);
    return typed(kTokenVector, start);
  }
  std::uint64_t encodeSamples(const Samples& samples) {
    // Each part stands behind the distance to what follows it.
    align();
    const std::uint64_t times = at_;
    putList(samples.times);
    const std::uint64_t start = at_;
    put(std::int64_t{8});
    put(typed(kDoubleVector, times));
    put(std::int64_t{8});
    putList(samples.values);
    return typed(kTimeSamples, start);
  }

  std::int32_t addPath(std::int32_t parent, const std::string& name, bool isProperty) {
    const auto number = static_cast<std::int32_t>(paths_.size());
    paths_.push_back({static_cast<std::int32_t>(token(name)), isProperty, {}});
    if (number > 0) paths_[static_cast<std::size_t>(parent)].children.push_back(number);
    return number;
  }
  void addSpec(std::int32_t path, SpecType type,
               const std::vector<std::pair<std::string, std::uint64_t>>& fields) {
    specPaths_.push_back(path), specTypes_.push_back(type);
    specFieldSets_.push_back(static_cast<std::int32_t>(fieldSets_.size()));
    for (const auto& [name, value] : fields) {
      fieldSets_.push_back(static_cast<std::int32_t>(fieldTokens_.size()));
      fieldTokens_.push_back(static_cast<std::int32_t>(token(name)));
      fieldValues_.push_back(value);
    }
    fieldSets_.push_back(-1);
  }

  std::vector<std::string> namesOf(const std::vector<int>& prims) const {
    std::vector<std::string> names;
    for (const int p : prims) names.push_back(prims_[static_cast<std::size_t>(p)].name);
    return names;
  }

  void addRoot(const UsdHead& head) {
    strings_.push_back(token(head.comment));
    const std::int32_t path = addPath(0, "", false);
    addSpec(path, kPseudoRootSpec,
            {{"defaultPrim", encode(Token{head.defaultPrim})},
             {"documentation", inlined(kString, 0)},
             {"endTimeCode", encode(head.last)},
             {"framesPerSecond", encode(head.rate)},
             {"metersPerUnit", encode(1.0)},
             {"startTimeCode", encode(head.first)},
             {"timeCodesPerSecond", encode(head.rate)},
             {"upAxis", encode(Token{head.yUp ? "Y" : "Z"})},
             {"primChildren", encodeTokens(namesOf(top_))}});
  }

  void addPrim(int number, std::int32_t parent) {
    const Prim& prim = prims_[static_cast<std::size_t>(number)];
    const std::int32_t path = addPath(parent, prim.name, false);
    pathNumbers_[number] = path;
    std::vector<std::string> properties;
    for (const int a : prim.attributes) properties.push_back(attributes_[static_cast<std::size_t>(a)].name);
    for (const Relation& relation : prim.relations) properties.push_back(relation.name);
    std::vector<std::pair<std::string, std::uint64_t>> fields{{"specifier", inlined(kSpecifier, 0)},
                                                              {"typeName", encode(Token{prim.type})}};
    if (!properties.empty()) fields.push_back({"properties", encodeTokens(properties)});
    if (!prim.children.empty()) fields.push_back({"primChildren", encodeTokens(namesOf(prim.children))});
    addSpec(path, kPrimSpec, fields);
    for (const int a : prim.attributes) addAttribute(a, path);
    for (const int child : prim.children) addPrim(child, path);
    // Targets lie below this prim, or were added before it.
    for (const Relation& relation : prim.relations) addRelation(relation, path);
  }

  void addAttribute(int number, std::int32_t parent) {
    const Attribute& a = attributes_[static_cast<std::size_t>(number)];
    std::vector<std::pair<std::string, std::uint64_t>> fields{{"typeName", encode(Token{a.type})}};
    if (a.uniform) fields.push_back({"variability", inlined(kVariability, 1)});
    if (!a.interpolation.empty()) fields.push_back({"interpolation", encode(Token{a.interpolation})});
    if (const auto value = defaults_.find(number); value != defaults_.end())
      fields.push_back({"default", value->second});
    if (const auto found = samples_.find(number); found != samples_.end())
      fields.push_back({"timeSamples", encodeSamples(found->second)});
    addSpec(addPath(parent, a.name, true), kAttributeSpec, fields);
  }

  void addRelation(const Relation& relation, std::int32_t parent) {
    constexpr std::uint8_t kExplicit = 1 << 0, kHasExplicitItems = 1 << 1;
    std::vector<std::int32_t> targets;
    for (const int target : relation.targets) targets.push_back(pathNumbers_.at(target));
    const std::uint64_t start = at_;
    put(static_cast<std::uint8_t>(kExplicit | kHasExplicitItems));
    putList(targets);
    addSpec(addPath(parent, relation.name, true), kRelationSpec,
            {{"variability", inlined(kVariability, 1)}, {"targetPaths", typed(kPathListOp, start)}});
  }

  /// Depth first: a path, its children, its next sibling.
  struct PathTable {
    std::vector<std::int32_t> numbers, tokens, jumps;
  };
  void listPath(std::int32_t number, bool hasSibling, PathTable& table) const {
    constexpr std::int32_t kSiblingOnly = 0, kChildOnly = -1, kNeither = -2;
    const Path& path = paths_[static_cast<std::size_t>(number)];
    const std::size_t at = table.numbers.size();
    table.numbers.push_back(number);
    table.tokens.push_back(path.isProperty ? -path.token : path.token);
    table.jumps.push_back(hasSibling ? kSiblingOnly : kNeither);
    for (std::size_t i = 0; i < path.children.size(); ++i)
      listPath(path.children[i], i + 1 < path.children.size(), table);
    // The way to the sibling, where children lie between.
    if (!path.children.empty())
      table.jumps[at] = hasSibling ? static_cast<std::int32_t>(table.numbers.size() - at) : kChildOnly;
  }

  void putPacked(const Bytes& packed) {
    put(static_cast<std::uint64_t>(packed.size()));
    put(packed.data(), packed.size());
  }
  void putPacked(const std::vector<std::int32_t>& values) { putPacked(packIntegers(values)); }

  std::uint64_t writeTables() {
    std::vector<Section> sections;
    const auto section = [&](const char* name, const auto& write) {
      align();
      Section s{{}, static_cast<std::int64_t>(at_), 0};
      std::strncpy(s.name, name, sizeof s.name - 1);
      write();
      s.size = static_cast<std::int64_t>(at_) - s.start;
      sections.push_back(s);
    };
    const auto count = [&](std::size_t n) { put(static_cast<std::uint64_t>(n)); };
    section("TOKENS", [&] {
      Bytes text;
      for (const std::string& t : tokens_) append(text, t.c_str(), t.size() + 1);
      count(tokens_.size()), count(text.size()), putPacked(packBytes(text));
    });
    section("STRINGS", [&] { putList(strings_); });
    section("FIELDS", [&] {
      Bytes values;
      append(values, fieldValues_.data(), fieldValues_.size());
      count(fieldTokens_.size()), putPacked(fieldTokens_), putPacked(packBytes(values));
    });
    section("FIELDSETS", [&] { count(fieldSets_.size()), putPacked(fieldSets_); });
    section("PATHS", [&] {
      PathTable table;
      listPath(0, false, table);
      count(paths_.size()), count(paths_.size());
      putPacked(table.numbers), putPacked(table.tokens), putPacked(table.jumps);
    });
    section("SPECS", [&] {
      count(specPaths_.size());
      putPacked(specPaths_), putPacked(specFieldSets_), putPacked(specTypes_);
    });
    align();
    const std::uint64_t contents = at_;
    putList(sections);
    return contents;
  }

  io::OutputFile out_;
  platform::DropBehind behind_;
  std::uint64_t at_ = 0;
  std::vector<std::string> tokens_;
  std::map<std::string, std::uint32_t> tokenNumbers_;
  std::vector<std::uint32_t> strings_;
  std::vector<std::int32_t> fieldTokens_;
  std::vector<std::uint64_t> fieldValues_;
  std::vector<std::int32_t> fieldSets_;  ///< numbers of fields; -1 ends a set
  std::vector<Path> paths_;
  std::vector<std::int32_t> specPaths_, specFieldSets_, specTypes_;
  std::map<int, std::uint64_t> defaults_;
  std::map<int, Samples> samples_;
  std::map<int, std::int32_t> pathNumbers_;  ///< of prims
};

}  // namespace

std::unique_ptr<UsdLayer> binaryLayer(const std::string& file) { return std::make_unique<BinaryLayer>(file); }

}  // namespace rubble::convert
