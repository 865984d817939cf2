#pragma once
/// Types of values in crate files.
#include <cmath>
#include <cstdint>
#include <optional>

namespace rubble::usd {

/// Numbers of the types of values.
enum class Type : int {
  Bool = 1,
  UChar,
  Int,
  UInt,
  Int64,
  UInt64,
  Half,
  Float,
  Double,
  String,
  Token,
  Asset,
  Matrix2 = 13,
  Matrix3,
  Matrix4,
  Quatd,
  Quatf,
  Quath,
  Vec2d,
  Vec2f,
  Vec2h,
  Vec2i,
  Vec3d,
  Vec3f,
  Vec3h,
  Vec3i,
  Vec4d,
  Vec4f,
  Vec4h,
  Vec4i,
  Dictionary,
  TokenListOp,
  StringListOp,
  PathListOp,
  ReferenceListOp,
  PathVector = 40,
  TokenVector,
  Specifier,
  Permission,
  Variability,
  SelectionMap,
  TimeSamples,
  Payload,
  DoubleVector,
  OffsetVector,
  StringVector,
  Block,
  PayloadListOp = 55,
  TimeCode
};

constexpr std::uint64_t kIsArray = 1ull << 63, kIsInlined = 1ull << 62, kIsCompressed = 1ull << 61,
                        kPayload = (1ull << 48) - 1;
/// Arrays below this size are not compressed, whatever their flag.
constexpr std::uint64_t kLeastCompressed = 16;

inline double halfToDouble(std::uint16_t h) {
  const int exponent = h >> 10 & 31, fraction = h & 1023;
  const double size = exponent == 0    ? std::ldexp(fraction, -24)
                      : exponent == 31 ? (fraction ? std::nan("") : INFINITY)
                                       : std::ldexp(1024 + fraction, exponent - 25);
  return h >> 15 ? -size : size;
}

/// Scalars of a type: their kind and number.
struct Layout {
  enum class Of { Byte, Int, UInt, Int64, UInt64, Half, Float, Double } of;
  std::size_t count;
  bool isQuaternion = false, isMatrix = false;
};
inline std::optional<Layout> layoutOf(Type type) {
  using Of = Layout::Of;
  switch (type) {
    case Type::Bool:
    case Type::UChar:
      return Layout{Of::Byte, 1};
    case Type::Int:
      return Layout{Of::Int, 1};
    case Type::UInt:
      return Layout{Of::UInt, 1};
    case Type::Int64:
      return Layout{Of::Int64, 1};
    case Type::UInt64:
      return Layout{Of::UInt64, 1};
    case Type::Half:
      return Layout{Of::Half, 1};
    case Type::Float:
      return Layout{Of::Float, 1};
    case Type::Double:
    case Type::TimeCode:
      return Layout{Of::Double, 1};
    case Type::Matrix2:
      return Layout{Of::Double, 4, false, true};
    case Type::Matrix3:
      return Layout{Of::Double, 9, false, true};
    case Type::Matrix4:
      return Layout{Of::Double, 16, false, true};
    case Type::Quatd:
      return Layout{Of::Double, 4, true};
    case Type::Quatf:
      return Layout{Of::Float, 4, true};
    case Type::Quath:
      return Layout{Of::Half, 4, true};
    case Type::Vec2d:
      return Layout{Of::Double, 2};
    case Type::Vec2f:
      return Layout{Of::Float, 2};
    case Type::Vec2h:
      return Layout{Of::Half, 2};
    case Type::Vec2i:
      return Layout{Of::Int, 2};
    case Type::Vec3d:
      return Layout{Of::Double, 3};
    case Type::Vec3f:
      return Layout{Of::Float, 3};
    case Type::Vec3h:
      return Layout{Of::Half, 3};
    case Type::Vec3i:
      return Layout{Of::Int, 3};
    case Type::Vec4d:
      return Layout{Of::Double, 4};
    case Type::Vec4f:
      return Layout{Of::Float, 4};
    case Type::Vec4h:
      return Layout{Of::Half, 4};
    case Type::Vec4i:
      return Layout{Of::Int, 4};
    default:
      return std::nullopt;
  }
}
inline std::size_t sizeOf(Layout::Of of) {
  using Of = Layout::Of;
  return of == Of::Byte ? 1 : of == Of::Half ? 2 : of == Of::Int || of == Of::UInt || of == Of::Float ? 4 : 8;
}

}  // namespace rubble::usd
