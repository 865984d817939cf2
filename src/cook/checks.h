#pragma once
/// Validation of input values. Each check throws Error with the path of the value, the expectation and the
/// actual value.
#include <span>
#include <string>
#include <vector>

#include <rubble/error.h>
#include <rubble/material.h>
#include <rubble/math.h>

#include "math/field.h"

namespace rubble::checks {

std::string text(double a);
std::string text(const Vec3& a);

bool isFinite(const Vec3& a);
void finite(double a, const Path& path);
void finite(const Vec3& a, const Path& path);
/// Checks each element; the path names it.
void finite(std::span<const double> list, const Path& path);
void finite(std::span<const Vec3> list, const Path& path);
void positive(double a, const Path& path);
void notNegative(double a, const Path& path);
/// For stiffnesses and thresholds, where infinity is allowed.
void positiveOrInfinite(double a, const Path& path);
void notNegativeOrInfinite(double a, const Path& path);
/// Principal moments: positive, none above the sum of the others.
void moments(const Vec3& a, const Path& path);
/// Unit length.
void unit(const Quat& q, const Path& path);
/// A length that is safe to normalize.
void rotation(const Quat& q, const Path& path);
void material(const Material& m, const Path& path);
/// The value of a field by its rules. `path`: of its owner.
void field(const FieldInfo& info, double value, const Path& path);
void field(const FieldInfo& info, const Vec3& value, const Path& path);
void field(const FieldInfo& info, const Quat& value, const Path& path);
inline void field(const FieldInfo&, bool, const Path&) {}
void field(const FieldInfo& info, const std::vector<double>& value, const Path& path);

[[noreturn]] void failEnumeration(long long value, long long last, const Path& path);
/// An enumerator from 0 to `last`.
template <class E> void enumeration(E value, E last, const Path& path) {
  const auto number = static_cast<long long>(value);
  if (number < 0 || number > static_cast<long long>(last))
    failEnumeration(number, static_cast<long long>(last), path);
}

}  // namespace rubble::checks
