#pragma once
/// Model files that tests write.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include <rubble/error.h>

#include "convert/import.h"

namespace rubble::test {

/// A folder that is removed with everything in it.
class ModelFolder {
 public:
  ModelFolder() {
    const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("rubble_") + info->test_suite_name() + "_" + info->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~ModelFolder() { std::filesystem::remove_all(path_); }
  ModelFolder(const ModelFolder&) = delete;

  std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The import of a text, in a folder of its own.
inline convert::Import importText(const std::string& text, const std::string& name = "model.xml",
                                  const convert::ImportOptions& options = {}) {
  const ModelFolder folder;
  return convert::importModel(folder.write(name, text), options);
}

/// A model with this content of <worldbody>, and further sections.
inline std::string mjcf(const std::string& world, const std::string& sections = "") {
  return "<mujoco>" + sections + "<worldbody>" + world + "</worldbody></mujoco>";
}

/// The message of the Error that an import throws, or "".
template <class F> std::string messageOf(F&& import) {
  try {
    import();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline const BodyDef& bodyNamed(const convert::Import& import, const std::string& name) {
  const auto& bodies = import.file.scene.bodies;
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const BodyDef& b) { return b.name == name; });
  if (found == bodies.end()) throw Error("bodies", "a body of that name", name);
  return *found;
}
inline const JointDef& jointNamed(const convert::Import& import, const std::string& name) {
  const auto& joints = import.file.scene.joints;
  const auto found = std::find_if(joints.begin(), joints.end(),
                                  [&](const JointDef& j) { return j.name == name; });
  if (found == joints.end()) throw Error("joints", "a joint of that name", name);
  return *found;
}
inline const ActuatorDef& actuatorNamed(const convert::Import& import, const std::string& name) {
  const auto& all = import.file.actuators;
  const auto found = std::ranges::find(all, name, &ActuatorDef::name);
  if (found == all.end()) throw Error("actuators", "an actuator of that name", name);
  return *found;
}
/// Do two bodies collide by their filters?
inline bool collide(const convert::Import& model, const std::string& first, const std::string& second) {
  const CollisionFilter &a = bodyNamed(model, first).filter, &b = bodyNamed(model, second).filter;
  return (a.layers & b.mask) != 0 && (b.layers & a.mask) != 0;
}

inline void expectNear(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "axis " << k;
}

/// The effects of the notes about `what`.
inline std::vector<convert::Effect> effectsOf(const convert::Import& import, const std::string& what) {
  std::vector<convert::Effect> out;
  for (const convert::Note& note : import.report.notes)
    if (note.what == what) out.push_back(note.effect);
  return out;
}

}  // namespace rubble::test
