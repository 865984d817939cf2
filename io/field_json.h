#pragma once
/// Values of fields (math/field.h) in files.
#include <optional>

#include <nlohmann/json.hpp>

#include "io/json_reader.h"
#include "math/field.h"

namespace rubble::io {

/// Reads the value of a field, if it is there. An infinite number has a word.
void readField(ObjectReader& object, const FieldInfo& field, double& out);
void readField(ObjectReader& object, const FieldInfo& field, bool& out);
void readField(ObjectReader& object, const FieldInfo& field, Vec3& out);
void readField(ObjectReader& object, const FieldInfo& field, Quat& out);
void readField(ObjectReader& object, const FieldInfo& field, std::vector<double>& out);
void readField(ObjectReader& object, const FieldInfo& field, std::optional<double>& out);
void readField(ObjectReader& object, const FieldInfo& field, std::optional<Vec3>& out);

nlohmann::ordered_json fieldJson(const FieldInfo& field, double value);
nlohmann::ordered_json fieldJson(const FieldInfo& field, bool value);
nlohmann::ordered_json fieldJson(const FieldInfo& field, const Vec3& value);
nlohmann::ordered_json fieldJson(const FieldInfo& field, const Quat& value);
nlohmann::ordered_json fieldJson(const FieldInfo& field, const std::vector<double>& value);

nlohmann::ordered_json vectorJson(const Vec3& v);
nlohmann::ordered_json quaternionJson(const Quat& q);

/// The same bits, so that -0 is not taken for 0.
bool sameBits(double a, double b);
bool sameBits(bool a, bool b);
bool sameBits(const Vec3& a, const Vec3& b);
bool sameBits(const Quat& a, const Quat& b);
bool sameBits(const std::vector<double>& a, const std::vector<double>& b);

/// Writes the value of a field that differs from the usual one.
template <class T>
void writeField(const FieldInfo& field, const T& value, const T& usual, nlohmann::ordered_json& json) {
  if (!sameBits(value, usual)) json[field.key] = fieldJson(field, value);
}
template <class T>
void writeField(const FieldInfo& field, const std::optional<T>& value, const std::optional<T>&,
                nlohmann::ordered_json& json) {
  if (value) json[field.key] = fieldJson(field, *value);
}
/// Of each field of a list in which `object` is not as a new one.
template <class Fields, class Object>
void writeFields(const Fields& fields, const Object& object, nlohmann::ordered_json& json) {
  forEachField(fields, object, [&, usual = Object{}](const auto& field, const auto& value) {
    writeField(field, value, usual.*field.member, json);
  });
}

}  // namespace rubble::io
