#pragma once
/// Edits of the tables. Bodies are addressed by id, everything else by slot or index.
#include <functional>
#include <variant>

#include "tables/records.h"

namespace rubble {

/// Adds, replaces or removes (kind 0) a body. `keepsState`: its state remains.
struct SetBody {
  int id;
  EngineBody body;
  bool keepsState = false;  ///< changes authored data only, of a body that exists
  int world = 0;
  int number = -1;  ///< id of the body in its world; -1: its id in the tables
};
/// Adds bodies that are made one at a time, so that many need no list. Body k is at(k), with an id below
/// `ids`; at() may be called by several engines at once, and does not throw.
struct AddBodies {
  int ids;
  int count;
  std::function<SetBody(int k)> at;
};
struct SetBodyState {
  int id;
  BodyState state;
};
/// For the next step, about the center of mass.
struct AddForce {
  int id;
  Vec3 force, torque;
};
struct AddVelocity {
  int id;
  Vec3 change;
};
/// Clears the contacts of bodies that are removed or replaced.
struct ForgetContacts {
  std::vector<int> ids;
};
/// Where the vectors, indices and parts of a shape begin in the tables.
struct ShapePlace {
  int vectors = 0, indices = 0, parts = 0;
  friend bool operator==(const ShapePlace&, const ShapePlace&) = default;
};
/// Writes the tables of a shape to a place that no other shape has. `partSurfaces`: materials of its parts as
/// indices into those of SetSurfaces; -1: that of the body.
struct AddShape {
  std::shared_ptr<const CookedShape> shape;
  std::vector<int> partSurfaces;
  ShapePlace place = {};
};
/// From here on no body has the shape at this place, which another one may take.
struct DropShape {
  ShapePlace place;
};
/// All materials, and rules of pairs of them, ascending in world, low and high.
struct SetSurfaces {
  std::vector<Material> surfaces;
  std::vector<EngineMaterialRule> rules = {};
};
/// The bodies that are planes.
struct SetPlanes {
  std::vector<int> ids;
  std::vector<int> firstOfWorld = {};  ///< of a batch: [worlds + 1] first element of each world
};
/// Adds, changes or removes a joint. `keepsState`: its multipliers remain.
struct SetJoint {
  int slot;
  EngineJoint joint;
  bool keepsState = false;
};
/// Whether two bodies never collide.
struct SetExcluded {
  int a, b;  ///< ids in their world
  bool excluded;
  int world = 0;
};
/// All deformable objects and attachments. Existing ones keep their relative order and their state.
struct SetDeformables {
  std::vector<EngineSoftObject> objects;
  std::vector<EngineAttachment> attachments;
};
struct SetVertices {
  int first;
  std::vector<Vec3> positions, velocities;
};
struct AddVertexForce {
  int vertex;
  Vec3 force;
};

using Edit = std::variant<SetBody, AddBodies, SetBodyState, AddForce, AddVelocity, ForgetContacts, AddShape,
                          DropShape, SetSurfaces, SetPlanes, SetJoint, SetExcluded, SetDeformables,
                          SetVertices, AddVertexForce>;

}  // namespace rubble
