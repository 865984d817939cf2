#pragma once
/// Many separate worlds in one set of tables and one step, for learning and for parameter studies.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rubble/world.h>

namespace rubble {

/// Report of a step of many worlds: sums over those that took part.
struct WorldsReport : StepReport {
  std::vector<int> brokenIn;  ///< the world of each of `broken`
};

/// Where the random numbers of a world stand. Number k of an episode is a hash of (seed, episode, k).
struct RandomState {
  std::uint64_t seed = 0;
  std::int64_t episode = 0;  ///< resets of the world since the seed was set
  std::int64_t drawn = 0;    ///< numbers of this episode that were drawn
};

/// Worlds that share one engine but nothing else: alike or different in all but the parameters of the step.
/// Each has its own origin, gravity, ids and events. World i has the bits that it has alone, whatever the
/// others are and do. Ids of bodies, joints and objects are those of their world.
class Worlds {
 public:
  /// Throws Error if the options are invalid. All worlds of a device are in one set of tables.
  explicit Worlds(const WorldOptions& options = {});
  ~Worlds();
  Worlds(Worlds&&) noexcept;
  Worlds& operator=(Worlds&&) noexcept;

  /// Adds a world and returns its number. Throws Error as the constructor of World does.
  int add(const Scene& scene);
  /// Adds that many worlds of one scene and returns the number of the first. Shapes are shared.
  int addCopies(const Scene& scene, int count);
  int count() const;

  /// One of the worlds, with everything that World offers. Its step() leaves all others as they are.
  /// Snapshots can be restored to every world of this batch. Not for one of many: sortBodies, setParams.
  World& operator[](int world);
  const World& operator[](int world) const;

  /// Advances all worlds by `steps` steps.
  WorldsReport step(int steps = 1);
  /// Advances the worlds whose element of `active` is not 0. All others keep their state, with the forces
  /// that wait for their next step. Throws Error unless there is one element per world.
  WorldsReport step(int steps, std::span<const char> active);

  /// Restores distinct worlds from one snapshot each, or all of them from one. A snapshot may be of another
  /// world of this batch. No other world is touched. Each begins the next episode of its random numbers.
  void reset(std::span<const int> worlds, std::span<const Snapshot> snapshots);

  const Params& params() const;
  void setParams(const Params& params);

  // Domain randomization: authored values of single worlds.
  /// Sets a value in each of these worlds, from the next step on. Paths have the names and keys of scene
  /// files (docs/worlds.md): "gravity", "bodies.pole.mass", "joints.hip.axes.0.drive_stiffness",
  /// "bodies[\"a.b\"].mass". World worlds[k] receives as many numbers as a value has, world after world. All
  /// worlds are checked first: an Error, which names the world, changes nothing.
  void setValues(const std::string& path, std::span<const int> worlds, std::span<const double> values);
  /// The present values, world after world.
  std::vector<double> values(const std::string& path, std::span<const int> worlds) const;

  // Random numbers. Each world has its own, which depend neither on the number of the worlds nor on draws and
  // resets of others. Snapshots do not have them.
  /// Gives each of these worlds a seed made of `seed` and its number, and begins with episode 0. Without
  /// `worlds`: all of them, and those that are added later. Worlds begin with a seed of 0.
  void setSeed(std::uint64_t seed);
  void setSeed(std::uint64_t seed, std::span<const int> worlds);
  RandomState randomState(int world) const;
  void setRandomState(int world, const RandomState& state);
  /// The next `count` numbers of each of these worlds, uniform from `low` to below `high`, world after world.
  std::vector<double> uniform(std::span<const int> worlds, int count, double low = 0, double high = 1);

  /// State of the bodies of all worlds, one row per body. Body k of world w has the row rowsOf(w)[k], which
  /// is firstRow(w) + k unless bodies were added to a world after others had been made. Worlds of one scene
  /// have an array of shape (worlds, bodies, numbers). On the host valid until the next call for the same
  /// array; steps and that call may change it. On a device valid until bodies are added or removed.
  ArrayView array(StateArray which) const;
  std::vector<int> rowsOf(int world) const;
  int firstRow(int world) const;
  /// As World::scatter, with rows of array().
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values);

  /// Joints of all worlds, one row per axis, world after world: World::axes() of world w begins at row
  /// firstAxis(w). As array() of states.
  ArrayView array(JointArray which) const;
  int firstAxis(int world) const;
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values);
  /// What sensors measure in all worlds. Rows are those of array() of states or, for joints, world after
  /// world.
  ArrayView array(SensorArray which) const;

  /// Vertices of the deformable objects of all worlds, world after world: those of world w begin at row
  /// firstVertex(w), the vertices of one of its objects World::firstVertex() rows later. As array() of
  /// states.
  ArrayView array(VertexArray which) const;
  int firstVertex(int world) const;

  /// World::contactForces() of pairs of rows of array(): two bodies of one world each.
  ArrayView contactForces(std::span<const std::array<int, 2>> rows) const;

  // As of World, for the arrays above.
  DeviceStream deviceStream() const;
  std::shared_ptr<void> addReader(std::uintptr_t stream) const;

  /// A ray in one of the worlds.
  struct WorldRay {
    int world;
    RayQuery ray;
  };
  /// World::castRays() for rays in many worlds. Hits name bodies of the world of the ray.
  std::vector<RayHit> castRays(std::span<const WorldRay> rays);
  /// World::castRayArrays() in many worlds. `worlds`: the world of each ray, (n, 1), "<i4", in the same
  /// memory. Without rows each world has as many rays, world after world.
  RayHitArrays castRayArrays(const RayArrays& rays, const ArrayView& worlds = {});

  std::size_t memoryBytes() const;

 private:
  friend class Actuators;
  friend class Sensors;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble
