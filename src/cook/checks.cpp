#include "cook/checks.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace rubble::checks {

std::string text(double a) {
  std::ostringstream out;
  out << a;
  return out.str();
}
std::string text(const Vec3& a) { return "(" + text(a.x) + ", " + text(a.y) + ", " + text(a.z) + ")"; }

namespace {

/// A larger number is refused like an infinite one: its square would be infinite in single precision.
constexpr double kLargestNumber = 1e18;
/// Likewise of a quaternion that is normalized.
constexpr double kLargestNorm = 1e9;

std::string bounded(const std::string& what) {
  return what + " of at most " + text(kLargestNumber) + " in size";
}

bool isFinite(double a) { return std::fabs(a) <= kLargestNumber; }
bool isUnit(const Quat& q) {
  constexpr double kNearlyUnit = 1e-3;
  return std::fabs(std::sqrt(q.s * q.s + dot(q.v, q.v)) - 1) < kNearlyUnit;
}

/// Does a number keep the rules of a field? `finite`: it may not be larger than any number.
bool holds(const FieldInfo& info, double a, bool finite) {
  if (finite && !isFinite(a)) return false;
  if (info.rules.range == FieldRange::Any) return true;
  return info.rules.range == FieldRange::Positive ? a > 0 : a >= 0;
}

}  // namespace

bool isFinite(const Vec3& a) { return isFinite(a.x) && isFinite(a.y) && isFinite(a.z); }

void finite(double a, const Path& path) {
  if (!isFinite(a)) throw Error(path, bounded("a number"), text(a));
}
void finite(const Vec3& a, const Path& path) {
  if (!isFinite(a)) throw Error(path, bounded("three numbers"), text(a));
}
void finite(std::span<const double> list, const Path& path) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!isFinite(list[i])) finite(list[i], path[i]);
}
void finite(std::span<const Vec3> list, const Path& path) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!isFinite(list[i])) finite(list[i], path[i]);
}
void positive(double a, const Path& path) {
  if (!(a > 0) || !isFinite(a)) throw Error(path, bounded("a number above 0 and"), text(a));
}
void notNegative(double a, const Path& path) {
  if (!(a >= 0) || !isFinite(a)) throw Error(path, bounded("a number of at least 0 and"), text(a));
}
void positiveOrInfinite(double a, const Path& path) {
  if (!(a > 0)) throw Error(path, "a number above 0 or infinity", text(a));
}
void notNegativeOrInfinite(double a, const Path& path) {
  if (!(a >= 0)) throw Error(path, "a number of at least 0 or infinity", text(a));
}

void moments(const Vec3& a, const Path& path) {
  for (int k = 0; k < 3; ++k) positive(a[k], path);
  constexpr double kRoundOff = 1 + 1e-9;
  if (a.x > (a.y + a.z) * kRoundOff || a.y > (a.z + a.x) * kRoundOff || a.z > (a.x + a.y) * kRoundOff)
    throw Error(path, "moments none of which is above the sum of the others", text(a));
}
void unit(const Quat& q, const Path& path) {
  if (!isUnit(q))
    throw Error(path, "a unit quaternion", "one of norm " + text(std::sqrt(q.s * q.s + dot(q.v, q.v))));
}
void rotation(const Quat& q, const Path& path) {
  const double norm = std::sqrt(q.s * q.s + dot(q.v, q.v));
  if (!(norm >= 1 / kLargestNorm && norm <= kLargestNorm))
    throw Error(path, "a quaternion of norm " + text(1 / kLargestNorm) + " to " + text(kLargestNorm),
                "one of norm " + text(norm));
}

void material(const Material& m, const Path& path) {
  notNegative(m.staticFriction, path + ".staticFriction");
  notNegative(m.dynamicFriction, path + ".dynamicFriction");
  if (m.dynamicFriction > m.staticFriction)
    throw Error(path + ".dynamicFriction", "at most the static friction " + text(m.staticFriction),
                text(m.dynamicFriction));
  notNegative(m.restitution, path + ".restitution");
  if (m.restitution > 1) throw Error(path + ".restitution", "at most 1", text(m.restitution));
  enumeration(m.frictionCombine, Combine::GeometricMean, path + ".frictionCombine");
  enumeration(m.restitutionCombine, Combine::GeometricMean, path + ".restitutionCombine");
  notNegative(m.rollingFriction, path + ".rollingFriction");
  notNegative(m.torsionalFriction, path + ".torsionalFriction");
  finite(m.surfaceVelocity, path + ".surfaceVelocity");
  finite(m.oneWay, path + ".oneWay");
}

// the name of a field is put together for an error only
void field(const FieldInfo& info, double value, const Path& path) {
  if (holds(info, value, !info.rules.infinity)) return;
  const std::string name = "." + std::string(info.name());
  const Path own = path + name;
  const bool infinite = info.rules.infinity != nullptr;
  if (info.rules.range == FieldRange::Positive)
    infinite ? positiveOrInfinite(value, own) : positive(value, own);
  else if (info.rules.range == FieldRange::NotNegative)
    infinite ? notNegativeOrInfinite(value, own) : notNegative(value, own);
  else if (!infinite)
    finite(value, own);
}
void field(const FieldInfo& info, const Vec3& value, const Path& path) {
  if (holds(info, value.x, true) && holds(info, value.y, true) && holds(info, value.z, true)) return;
  const std::string name = "." + std::string(info.name());
  const Path own = path + name;
  if (info.rules.range == FieldRange::Any) return finite(value, own);
  const auto check = info.rules.range == FieldRange::Positive ? positive : notNegative;
  check(value.x, own + ".x"), check(value.y, own + ".y"), check(value.z, own + ".z");
}
void field(const FieldInfo& info, const Quat& value, const Path& path) {
  if (isUnit(value)) return;
  unit(value, path + ("." + std::string(info.name())));
}

void field(const FieldInfo& info, const std::vector<double>& value, const Path& path) {
  if (std::ranges::all_of(value, [](double each) { return isFinite(each); })) return;
  finite(value, path + ("." + std::string(info.name())));
}

void failEnumeration(long long value, long long last, const Path& path) {
  throw Error(path, "one of an enumeration, 0 to " + std::to_string(last), std::to_string(value));
}

}  // namespace rubble::checks
