#pragma once
/// Joints of scene files.
#include <functional>

#include "io/json_reader.h"

namespace rubble::io {

/// The rest of a joint whose type and bodies are known (`out`), of a scene whose bodies are read.
void readJoint(ObjectReader& object, JointDef& out, const Scene& scene);
/// Of that, what does not depend on bodies: stiffnesses, thresholds, axes.
void readJointValues(ObjectReader& object, JointDef& out);

/// Keywords of all joint types, in the order of JointType.
const std::vector<std::string>& jointKeywords();

enum class FieldRange { Any, NotNegative, Positive };

/// One field of a joint in files: its key, where it is, and what is said about it.
struct JointField {
  const char* key;
  double JointDef::*member;
  FieldRange range;
  const char* word;  ///< for infinity: "hard", "never", "free"; null: it must be finite
  const char* unit;
  const char* doc;
};
struct AxisField {
  const char* key;
  double JointAxis::*member;
  FieldRange range;
  const char* word;
  const char* unit;
  const char* doc;
};
const std::vector<JointField>& jointFields();
const std::vector<AxisField>& axisFields();

/// Axes that a file may describe for a joint of this type.
std::size_t axesInFile(JointType type);
/// Do the joint's axes matter?
bool usesFrames(JointType type);

/// A joint as files have it; `reference`: how it refers to a body by its index.
nlohmann::ordered_json jointJson(const JointDef& joint,
                                 const std::function<nlohmann::ordered_json(int)>& reference);

}  // namespace rubble::io
