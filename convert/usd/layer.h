#pragma once
/// USD layers as they are read: prims with their properties, before and after composition.
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rubble::usd {

/// A value without its exact type. Tuples and arrays are flattened: three points are nine numbers.
struct Value {
  std::vector<double> numbers;     ///< booleans are 0 and 1; quaternions scalar first
  std::vector<std::string> texts;  ///< tokens, strings, and names of assets

  bool empty() const { return numbers.empty() && texts.empty(); }
};

struct Property {
  std::string name, type;  ///< type: "point3f[]"; "": a relationship
  Value value;
  std::vector<std::string> targets;  ///< absolute paths, of relationships and connections
  bool isAnimated = false;           ///< the value is that of the first time sample
  int line = 0;                      ///< 0: unknown, for crates have no lines
  std::string file;
};

/// A prim elsewhere that this one takes its content from.
struct Arc {
  std::string asset;  ///< "": the same layer
  std::string path;   ///< "": the default prim
  int line = 0;
};

struct Prim {
  enum class Kind { Over, Def, Class };
  std::string name, type;
  Kind kind = Kind::Over;
  bool active = true;
  std::vector<std::string> schemas;  ///< applied API schemas
  std::vector<Property> properties;
  std::vector<std::unique_ptr<Prim>> children;
  std::vector<Arc> references, inherits;  ///< references: with payloads; inherits: with specializes
  std::map<std::string, std::string> selections;
  std::map<std::string, std::map<std::string, std::unique_ptr<Prim>>> variants;
  std::string file;
  int line = 0;

  Prim* child(const std::string& wanted) const;
  const Property* find(const std::string& wanted) const;
  bool hasSchema(const std::string& wanted) const;
  std::unique_ptr<Prim> copy() const;
};

struct Layer {
  std::string file;
  Prim root;
  std::string defaultPrim, upAxis;
  double metersPerUnit = 0, kilogramsPerUnit = 0;  ///< 0: not given
  std::vector<std::string> subLayers;
};

/// Parse a layer; `file` is its name in errors. Throw Error with file and line, or with the byte, of what is
/// wrong.
Layer parseText(const std::string& text, const std::string& file);
Layer parseCrate(const std::string& bytes, const std::string& file);
/// Either, by its first bytes.
Layer parse(const std::string& bytes, const std::string& file);

/// Most prims of a layer or a stage, and deepest level of prims and of references.
inline constexpr std::size_t kMostPrims = 500000;
inline constexpr int kMostDepth = 100;

/// Appends "/name", or ".name" below a prim.
inline std::string joined(const std::string& path, const std::string& name) {
  return (path == "/" ? "" : path) + "/" + name;
}

}  // namespace rubble::usd
