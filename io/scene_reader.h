#pragma once
/// Reads a scene as a whole or element by element.
#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/body_reader.h"
#include "io/scene_json.h"

namespace rubble::io {

class SceneReader {
 public:
  /// Faults go to `faults`. Mesh files lie in `folder`, unless a full path is given.
  explicit SceneReader(std::vector<Fault>& faults, std::string folder = "")
      : faults_(faults), folder_(std::move(folder)) {}

  SceneFile read(const JsonValue& json);

  /// Keys of a scene that are no lists: "gravity", "materials", "camera".
  static const std::vector<std::string>& keys();
  /// Keys of the lists of a scene, in the order in which they are read: "bodies", "joints".
  static const std::vector<std::string>& lists();
  /// Sets the value of a key. Notes a fault for a key that is not in keys().
  void set(SceneFile& out, const std::string& key, const Node& value);
  /// Adds an element to a list. What the element names must have been added before. Notes a fault for a
  /// list that is not in lists().
  void add(SceneFile& out, const std::string& list, const Node& element);
  /// Takes the names of a scene that was made otherwise, so that elements can be added to it.
  void adopt(const SceneFile& file);
  /// Removes the last element of a list, which was found invalid, and its name.
  void dropLast(SceneFile& out, const std::string& list);

 private:
  void addBody(Scene& scene, const Node& element);
  void addLook(SceneFile& out, const Node& element);
  void addCamera(SceneFile& out, const Node& element);
  void addLight(SceneFile& out, const Node& element);
  void addExclusion(Scene& scene, const Node& element);
  JointDef joint(const Node& node, const Scene& scene);
  int jointOfType(const Node& node, const Scene& scene, JointType type);
  void coupling(ObjectReader& object, JointDef& out, const Scene& scene);
  int bodyIndex(const Node& node, const Scene& scene);
  /// The index of a joint by its name or index, or -1.
  int jointIndex(const Node& node, const Scene& scene);
  Event event(const Node& node, const Scene& scene);
  Event::Turn turn(const Node& node);
  void checkRemoval(const Node& node, const std::string& pattern, const Scene& scene);
  FileClaim claim(const Node& node);
  FileCamera camera(const Node& node);
  std::vector<std::string> bodyNames() const;

  std::vector<Fault>& faults_;
  std::string folder_;  ///< of mesh files
  BodyReader bodyReader_;
  std::map<std::string, int> bodies_;  ///< index in the scene by name; -1 for a body that an event adds
  std::set<std::string> joints_;
};

}  // namespace rubble::io
