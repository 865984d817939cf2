#pragma once
/// State of a USD import (UsdPhysics: https://openusd.org/release/api/usd_physics_page_front.html).
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "convert/folders.h"
#include "convert/free_model.h"
#include "convert/import.h"
#include "convert/usd/stage.h"
#include "convert/usd_files.h"

namespace rubble::convert {

/// A property of a prim by typed access. What is read is marked as used.
class UsdPrim {
 public:
  UsdPrim(const usd::Prim& prim, std::unordered_set<const usd::Property*>& used)
      : prim_(&prim), used_(&used) {}

  const usd::Prim& prim() const { return *prim_; }
  Place place() const { return {prim_->file, prim_->line}; }
  bool has(const std::string& key) const;
  /// The first number; not finite ones, and those above 1e15, are Errors unless they are `infinite`.
  double number(const std::string& key, double otherwise, bool infinite = false) const;
  bool flag(const std::string& key, bool otherwise) const { return number(key, otherwise) != 0; }
  std::optional<std::vector<double>> numbers(const std::string& key, std::size_t count) const;
  std::optional<Vec3> vector(const std::string& key) const;
  std::optional<Quat> quaternion(const std::string& key) const;
  std::string text(const std::string& key, const std::string& otherwise = "") const;
  /// The list of an array.
  const std::vector<double>* list(const std::string& key) const;
  const std::vector<std::string>* targets(const std::string& key) const;
  [[noreturn]] void fail(const std::string& key, const std::string& expected, const std::string& got) const;

 private:
  const usd::Property* find(const std::string& key) const;

  const usd::Prim* prim_;
  std::unordered_set<const usd::Property*>* used_;
};

class UsdReader {
 public:
  UsdReader(Folders& folders, Report& report) : folders_(folders), report_(report) {}
  Model read(const std::string& bytes, const std::string& file);

 private:
  struct Placed {
    const usd::Prim* prim;
    std::string path;
    Affine world;       ///< in meters, z up
    int link;           ///< -1: the world
    int instance = -1;  ///< index into instances_
    int geom = -1;      ///< of a collider: its first geom in the link
  };
  /// A prototype, where it is placed, and the instance that its instancer belongs to (or -1).
  struct Instance {
    std::string prototype, path;
    int outer;
  };

  // usd.cpp
  void readScene(const UsdPrim& prim);
  void visit(const usd::Prim& prim, const std::string& path, const Affine& parent, int link);
  int addBody(const UsdPrim& prim, const std::string& path, const Affine& parent, const Affine& world);
  void finishMass(int link);
  /// A prim, of whatever kind it is, with all below it.
  void placeAll(const usd::Prim& prim, const std::string& path, const Affine& parent, int link);
  void addFilters();
  void noteUnused();
  UsdPrim at(const usd::Prim& prim) { return {prim, used_}; }

  // usd_instances.cpp
  void addInstances(const usd::Prim& prim, const std::string& path, const Affine& world, int link);
  /// The path of a target of a placed prim: within the instance where the file names its prototype.
  std::string inInstance(const Placed& from, const std::string& target) const;

  // usd_frames.cpp
  /// The transformation of a prim to its parent. `resets`: it is to the world.
  Affine localFrame(const UsdPrim& prim, bool& resets) const;

  // usd_shapes.cpp
  void addCollider(const UsdPrim& prim, Placed& placed);
  bool shapeOf(const UsdPrim& prim, FreeShape& shape);
  bool meshOf(const UsdPrim& prim, FreeShape& shape);
  struct Surface {
    Material material;
    double density = 0;  ///< 0: not given [kg/m3]
  };
  Surface surfaceOf(const UsdPrim& prim, const std::string& path);
  /// The material that is bound to a prim, or to the nearest one above that has one; nothing if it has none.
  std::optional<UsdPrim> boundMaterial(const UsdPrim& prim, const std::string& path, bool forPhysics);

  // usd_looks.cpp
  /// Adds a prim to what is seen of its link.
  void addDrawn(const UsdPrim& prim, const Placed& placed);
  void addCamera(const UsdPrim& prim, const Affine& world);
  bool isVisible(const std::string& path);
  std::optional<Vec3> colorOf(const UsdPrim& prim, const std::string& path);

  // usd_joints.cpp
  void addJoint(const UsdPrim& prim, const Placed& placed);
  bool addAxes(const UsdPrim& prim, std::array<JointAxis, 6>& axes, int axis);
  void addDrive(const UsdPrim& prim, const std::string& name, bool turns, JointAxis& axis);
  /// The pose in its link of a frame at a body of a joint; nothing if the body is not there.
  std::optional<Pose> endOf(const Placed& joint, const char* body, const char* position, const char* rotation,
                            int& link);

  double length(double value) const { return value * metersPerUnit_; }

  Folders& folders_;
  Report& report_;
  Model model_;
  double metersPerUnit_ = 1, kilogramsPerUnit_ = 1;
  bool yUp_ = false;
  const usd::Prim* stage_ = nullptr;
  std::vector<Placed> placed_;
  std::unordered_map<std::string, std::size_t> byPath_;
  struct Collider {
    int link;
    SolidSums solid;                                   ///< at density 1, in the frame of the link
    double mass = 0, density = 0, surfaceDensity = 0;  ///< 0: not given [kg], [kg/m3]
  };
  std::vector<Collider> colliders_;
  std::vector<const usd::Prim*> bodyPrims_;  ///< of each link
  std::vector<std::size_t> joints_;          ///< indices into placed_
  std::unordered_set<const usd::Property*> used_;
  std::vector<Instance> instances_;
  int instance_ = -1;  ///< that is being placed
  bool hasScene_ = false;
};

Model readUsd(const std::string& bytes, const std::string& file, Folders& folders, Report& report);
bool isUsdFile(const std::string& file);

}  // namespace rubble::convert
