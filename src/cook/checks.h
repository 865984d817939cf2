#pragma once
/// What numbers from outside have to be. Each check throws Error with the path of what is wrong, what was
/// expected and what came.
#include <span>
#include <string>

#include <rubble/error.h>
#include <rubble/material.h>
#include <rubble/math.h>

namespace rubble::checks {

std::string text(double a);
std::string text(const Vec3& a);
/// "list[k]"
std::string element(const std::string& list, std::size_t k);

bool isFinite(const Vec3& a);
void finite(double a, const std::string& path);
void finite(const Vec3& a, const std::string& path);
/// Of a list, each with its place behind the path.
void finite(std::span<const double> list, const std::string& path);
void finite(std::span<const Vec3> list, const std::string& path);
void positive(double a, const std::string& path);
void notNegative(double a, const std::string& path);
/// A stiffness or a threshold: infinity is meant.
void positiveOrInfinite(double a, const std::string& path);
void notNegativeOrInfinite(double a, const std::string& path);
/// Of length 1.
void unit(const Quat& q, const std::string& path);
/// Of any length that it can be divided by.
void rotation(const Quat& q, const std::string& path);
void material(const Material& m, const std::string& path);

[[noreturn]] void failEnumeration(long long value, long long last, const std::string& path);
/// One of an enumeration that counts from 0 to `last`.
template <class E> void enumeration(E value, E last, const std::string& path) {
  const auto number = static_cast<long long>(value);
  if (number < 0 || number > static_cast<long long>(last))
    failEnumeration(number, static_cast<long long>(last), path);
}

}  // namespace rubble::checks
