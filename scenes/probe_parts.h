#pragma once
/// Parts that probes are made of; for the probe files only.
#include <string>
#include <vector>

#include "registry.h"

namespace rubble::scenes {

/// Has the world reached that time, to half a step? Times are sums of steps.
inline bool reached(const World& world, double seconds) {
  return world.time() > seconds - .5 * world.params().dt;
}

/// Bodies of the scene, with where they started.
struct Watched {
  int sceneIndex = -1;
  BodyId id;
  Vec3 start;           ///< position at the start of the run [m]
  double halfEdge = 0;  ///< half the smallest edge, or the radius [m]
};
/// `start` and `id` are filled in by begin().
std::vector<Watched> watch(const Scene& scene, const std::vector<int>& sceneIndices);
void begin(std::vector<Watched>& bodies, const World& world);

/// Largest height of a shape over its center, along `up` [m].
double reach(const Shape& shape, const Quat& orientation, const Vec3& up);
/// Height of the surface of the body "ground" along up; without one, -infinity.
double groundHeight(const Scene& scene);

/// A probe that follows one body by name.
class BodyProbe : public Probe {
 public:
  explicit BodyProbe(std::string name) : name_(std::move(name)) {}
  void start(const World& world) override {
    id_ = world.findBody(name_);
    first_ = world.state(id_);
  }

 protected:
  BodyState state(const World& world) const { return world.state(id_); }
  BodyId id() const { return id_; }
  const BodyState& first() const { return first_; }

 private:
  std::string name_;
  BodyId id_;
  BodyState first_;
};

/// Measures once: at a time, or (unless it `waits`) at the end of a run that is shorter.
class MomentProbe : public Probe {
 public:
  explicit MomentProbe(double at, bool waits = false) : at_(at), waits_(waits) {}
  void afterStep(const World& world, const StepReport& report) override;
  void finish(const World& world, Metrics& metrics) final;

 protected:
  virtual void measure(const World& world, Metrics& metrics) = 0;
  /// Values over the whole run.
  virtual void conclude(Metrics& metrics) const { (void)metrics; }

 private:
  double at_;
  bool waits_;
  bool done_ = false;
  Metrics metrics_;
};

}  // namespace rubble::scenes
