#pragma once
/// A USD layer that is written as it comes: prims and their attributes in memory, time samples to the disk.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <rubble/math.h>

namespace rubble::convert {

using Vec3f = Vec3T<float>;
/// Quaternions in the order of USD's memory: x, y, z, then the scalar.
using Quat4f = std::array<float, 4>;
using Quat4h = std::array<std::uint16_t, 4>;

/// Text that is a token ("none") and not a string.
struct Token {
  std::string text;
};
using Matrix4 = std::array<double, 16>;  ///< rows; points are rows on its left

using UsdValue = std::variant<bool, float, double, Token, std::array<float, 2>, Matrix4,
                              std::span<const Vec3f>, std::span<const Quat4f>, std::span<const Quat4h>,
                              std::span<const int>, std::span<const std::int64_t>, std::span<const float>,
                              std::span<const Token>>;

/// Settings of the whole layer.
struct UsdHead {
  std::string defaultPrim;
  bool yUp = false;
  double first = 0, last = 0;  ///< time codes
  double rate = 24;            ///< time codes per second
  std::string comment;
};

class UsdLayer {
 public:
  virtual ~UsdLayer() = default;

  /// A prim below another, or at the top for -1; returns its number. Type names are USD's ("Mesh").
  int prim(int parent, const std::string& name, const std::string& type);
  /// Name of a prim that USD allows, made of any text, and that no sibling has.
  std::string freeName(int parent, const std::string& wanted) const;
  std::string pathOf(int prim) const;
  /// Returns the number of an attribute of a type of USD ("point3f[]"). `interpolation` of a primvar, or "".
  int attribute(int prim, const std::string& type, const std::string& name,
                const std::string& interpolation = "", bool uniform = false);
  virtual void set(int attribute, const UsdValue& value) = 0;
  /// Times of an attribute ascend.
  virtual void sample(int attribute, double time, const UsdValue& value) = 0;
  void relate(int prim, const std::string& name, const std::vector<int>& targets);
  /// Writes what is left. Throws Error if the file could not be written in full.
  virtual void finish(const UsdHead& head) = 0;

 protected:
  struct Attribute {
    std::string type, name, interpolation;
    bool uniform;
  };
  struct Relation {
    std::string name;
    std::vector<int> targets;
  };
  struct Prim {
    std::string name, type;
    int parent;
    std::vector<int> children, attributes;
    std::vector<Relation> relations;
  };
  std::vector<Prim> prims_;
  std::vector<Attribute> attributes_;
  std::vector<int> top_;
};

/// Throws Error if the file cannot be written.
std::unique_ptr<UsdLayer> textLayer(const std::string& file);    ///< .usda
std::unique_ptr<UsdLayer> binaryLayer(const std::string& file);  ///< .usdc

}  // namespace rubble::convert
