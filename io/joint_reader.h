#pragma once
/// Joints of scene files.
#include <functional>

#include <nlohmann/json.hpp>

#include "forces/joint_kind.h"
#include "io/json_reader.h"

namespace rubble::io {

/// The rest of a joint whose type and bodies are known (`out`), of a scene whose bodies are read.
void readJoint(ObjectReader& object, JointDef& out, const Scene& scene);
/// Of that, what does not depend on bodies: stiffnesses, thresholds, axes.
void readJointValues(ObjectReader& object, JointDef& out);

/// Keywords of all joint types, in the order of JointType.
const std::vector<std::string>& jointKeywords();

/// Fields of a joint in files, in their order there, without its anchors and frames. Files of any type may
/// have the fields that JointDef has. `kind`: one of jointKinds().
const std::vector<JointField>& valueFields(const JointKind& kind);

/// A joint as files have it; `reference`: how it refers to a body by its index.
nlohmann::ordered_json jointJson(const JointDef& joint,
                                 const std::function<nlohmann::ordered_json(int)>& reference);

}  // namespace rubble::io
