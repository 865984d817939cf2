#pragma once
/// Values of fields (math/field.h) in files.
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

}  // namespace rubble::io
