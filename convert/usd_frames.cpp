/// Typed properties of prims, and their transformations.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <rubble/error.h>

#include "convert/rotations.h"
#include "convert/usd_reader.h"

namespace rubble::convert {

constexpr double kLargest = 1e15;

const usd::Property* UsdPrim::find(const std::string& key) const {
  const usd::Property* const found = prim_->find(key);
  if (found) used_->insert(found);
  return found;
}
bool UsdPrim::has(const std::string& key) const {
  const usd::Property* const found = prim_->find(key);
  return found && !found->value.empty();
}
void UsdPrim::fail(const std::string& key, const std::string& expected, const std::string& got) const {
  const usd::Property* const found = prim_->find(key);
  const int line = found && found->line > 0 ? found->line : prim_->line;
  const std::string& file = found && !found->file.empty() ? found->file : prim_->file;
  throw Error(file + ":" + std::to_string(line) + ": " + prim_->name + "." + key, expected, got);
}
double UsdPrim::number(const std::string& key, double otherwise, bool infinite) const {
  const usd::Property* const found = find(key);
  if (!found || found->value.numbers.empty()) return otherwise;
  const double value = found->value.numbers[0];
  if (infinite && std::isinf(value)) return value;
  if (infinite && std::fabs(value) > kLargest) return std::copysign(INFINITY, value);
  if (!(std::fabs(value) <= kLargest)) fail(key, "a number of at most 1e15", std::to_string(value));
  return value;
}
std::optional<std::vector<double>> UsdPrim::numbers(const std::string& key, std::size_t count) const {
  const usd::Property* const found = find(key);
  if (!found || found->value.numbers.empty()) return std::nullopt;
  if (found->value.numbers.size() != count)
    fail(key, std::to_string(count) + " numbers", std::to_string(found->value.numbers.size()));
  return found->value.numbers;
}
std::optional<Vec3> UsdPrim::vector(const std::string& key) const {
  const auto v = numbers(key, 3);
  if (!v) return std::nullopt;
  return Vec3{(*v)[0], (*v)[1], (*v)[2]};
}
std::optional<Quat> UsdPrim::quaternion(const std::string& key) const {
  const auto v = numbers(key, 4);
  if (!v) return std::nullopt;
  const double norm = std::hypot(std::hypot((*v)[0], (*v)[1]), std::hypot((*v)[2], (*v)[3]));
  if (!(norm > 1e-10 && norm < kLargest)) return std::nullopt;
  return normalize(Quat{(*v)[0] / norm, (*v)[1] / norm, (*v)[2] / norm, (*v)[3] / norm});
}
std::string UsdPrim::text(const std::string& key, const std::string& otherwise) const {
  const usd::Property* const found = find(key);
  return found && !found->value.texts.empty() ? found->value.texts[0] : otherwise;
}
const std::vector<double>* UsdPrim::list(const std::string& key) const {
  const usd::Property* const found = find(key);
  return found ? &found->value.numbers : nullptr;
}
const std::vector<std::string>* UsdPrim::targets(const std::string& key) const {
  const usd::Property* const found = find(key);
  return found && !found->targets.empty() ? &found->targets : nullptr;
}

namespace {

Affine inverse(const Affine& a) {
  const double d = a.determinant();
  const Vec3 u = cross(a.y, a.z) / d, v = cross(a.z, a.x) / d, w = cross(a.x, a.y) / d;  // rows
  Affine out{{u.x, v.x, w.x}, {u.y, v.y, w.y}, {u.z, v.z, w.z}, {}};
  out.t = -out.direction(a.t);
  return out;
}

Affine turned(const Quat& q) { return Affine::of({{}, q}); }

/// An operation by its type, the second part of its name: "xformOp:rotateXYZ:pivot".
Affine operation(const UsdPrim& prim, const std::string& name) {
  const std::size_t begin = name.find(':') + 1;
  const std::string type = name.substr(begin, name.find(':', begin) - begin);
  constexpr double kDegree = std::numbers::pi / 180;
  if (type == "transform") {
    const auto m = prim.numbers(name, 16);
    if (!m) return {};
    const auto row = [&](std::size_t i) { return Vec3{(*m)[4 * i], (*m)[4 * i + 1], (*m)[4 * i + 2]}; };
    return {row(0), row(1), row(2), row(3)};
  }
  if (type == "orient") return turned(prim.quaternion(name).value_or(Quat{}));
  if (type.size() == 7 && type.starts_with("rotate")) {
    const int axis = type[6] - 'X';
    if (axis < 0 || axis > 2) prim.fail(name, "an operation of USD", type);
    return turned(fromAxisAngle({axis == 0 ? 1. : 0., axis == 1 ? 1. : 0., axis == 2 ? 1. : 0.},
                                prim.number(name, 0) * kDegree));
  }
  if (type.size() == 9 && type.starts_with("rotate")) {
    const Vec3 angles = prim.vector(name).value_or(Vec3{});
    // about fixed axes, in the order of the name; angles are by axis
    Vec3 inOrder;
    for (int i = 0; i < 3; ++i) {
      const int axis = type[6 + static_cast<std::size_t>(i)] - 'X';
      if (axis < 0 || axis > 2) prim.fail(name, "an operation of USD", type);
      inOrder[i] = angles[axis] * kDegree;
    }
    return turned(quatOfEuler(inOrder, type.substr(6)));
  }
  if (type == "translateX" || type == "translateY" || type == "translateZ" || type == "scaleX" ||
      type == "scaleY" || type == "scaleZ") {
    const bool moves = type.starts_with("translate");
    Vec3 v = moves ? Vec3{} : Vec3{1, 1, 1};
    v[type.back() - 'X'] = prim.number(name, moves ? 0 : 1);
    return moves ? Affine::of({v, {}}) : Affine::scaling(v);
  }
  if (type == "translate") return Affine::of({prim.vector(name).value_or(Vec3{}), {}});
  if (type == "scale") return Affine::scaling(prim.vector(name).value_or(Vec3{1, 1, 1}));
  prim.fail(name, "an operation of USD", type);
}

}  // namespace

Affine UsdReader::localFrame(const UsdPrim& prim, bool& resets) const {
  resets = false;
  Affine out;
  const usd::Property* const order = prim.prim().find("xformOpOrder");
  if (!order) return out;
  prim.text("xformOpOrder");
  for (std::string name : order->value.texts) {
    if (name == "!resetXformStack!") {
      resets = true, out = {};
      continue;
    }
    const bool inverts = name.starts_with("!invert!");
    if (inverts) name = name.substr(std::string_view("!invert!").size());
    Affine own = operation(prim, name);
    if (!own.isFinite()) prim.fail(name, "numbers of at most 1e15", "others");
    if (inverts) {
      if (!(std::fabs(own.determinant()) > 1e-30)) prim.fail(name, "an operation with an inverse", "none");
      own = inverse(own);
    }
    out = out * own;
  }
  return out;
}

}  // namespace rubble::convert
