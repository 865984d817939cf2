#include "probes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "build.h"
#include "probe_parts.h"

namespace rubble::scenes {
namespace {

constexpr double kSampleSeconds = .1;

class QualityProbe final : public MomentProbe {
 public:
  QualityProbe(double at, const std::string& prefix) : MomentProbe(at, !prefix.empty()), prefix_(prefix) {}

  void afterStep(const World& world, const StepReport& report) override {
    quarantined_ = std::max(quarantined_, report.quarantined);
    broken_ += report.brokenJoints;
    MomentProbe::afterStep(world, report);
  }

 private:
  void measure(const World& world, Metrics& metrics) override {
    const Quality quality = world.quality();
    metrics[prefix_ + "penetration_mean_m"] = quality.penetration.mean;
    metrics[prefix_ + "penetration_p99_m"] = quality.penetration.p99;
    metrics[prefix_ + "penetration_max_m"] = quality.penetration.max;
    metrics[prefix_ + "joint_gap_mean_m"] = quality.jointGapMean;
    metrics[prefix_ + "joint_gap_max_m"] = quality.jointGapMax;
    metrics[prefix_ + "kinetic_energy_j"] = quality.kineticEnergy;
    metrics[prefix_ + "max_speed_m_s"] = quality.maxSpeed;
  }

  void conclude(Metrics& metrics) const override {
    metrics[prefix_ + "quarantined"] = quarantined_;
    metrics[prefix_ + "broken_joints"] = broken_;
  }

  std::string prefix_;
  int quarantined_ = 0;
  int broken_ = 0;
};

/// How far a stack is from where it started.
struct Displacement {
  double meanDrop = 0;     ///< [m]
  double largest = 0;      ///< [m]
  int moved = 0;           ///< bricks displaced by more than half their smallest edge
  double lowestPoint = 0;  ///< height of the lowest point of a brick [m]
};

Displacement displacement(const World& world, const std::vector<Watched>& bodies, const Vec3& up) {
  Displacement result;
  result.lowestPoint = std::numeric_limits<double>::infinity();
  for (const Watched& body : bodies) {
    if (!world.alive(body.id)) continue;
    const BodyState state = world.state(body.id);
    const Vec3 offset = state.position - body.start;
    const double distance = length(offset);
    result.meanDrop -= dot(offset, up) / double(bodies.size());
    // A body that is not finite is lost, not the largest number so far.
    result.largest = distance <= result.largest ? result.largest : distance;
    if (!(distance <= body.halfEdge)) ++result.moved;
    const double low = dot(state.position, up) -
                       reach(world.definition(body.id).shape, state.orientation, up);
    result.lowestPoint = std::min(result.lowestPoint, low);
  }
  return result;
}

class StackProbe final : public MomentProbe {
 public:
  StackProbe(const Scene& scene, double at)
      : MomentProbe(at),
        at_(at),
        up_(upOf(scene)),
        ground_(groundHeight(scene)),
        bricks_(watch(scene, dynamicBodies(scene))),
        top_(watch(scene, topLayer(scene))) {}

  void start(const World& world) override {
    begin(bricks_, world);
    begin(top_, world);
  }

  void afterStep(const World& world, const StepReport& report) override {
    if (reached(world, nextSample_) && !reached(world, at_)) {
      peak_ = std::max(peak_, displacement(world, top_, up_).meanDrop);
      nextSample_ += kSampleSeconds;
    }
    MomentProbe::afterStep(world, report);
  }

 private:
  void measure(const World& world, Metrics& metrics) override {
    const Displacement all = displacement(world, bricks_, up_);
    const double drop = displacement(world, top_, up_).meanDrop;
    metrics["top_drop_m"] = drop;
    metrics["top_drop_peak_m"] = std::max(drop, peak_);
    metrics["max_drift_m"] = all.largest;
    metrics["bricks_lost"] = all.moved;
    metrics["lowest_m"] = all.lowestPoint - ground_;
  }

  double at_;
  Vec3 up_;
  double ground_;
  std::vector<Watched> bricks_, top_;
  double nextSample_ = kSampleSeconds;
  double peak_ = 0;
};

/// The end of a run that went beyond the smash.
class SmashProbe final : public Probe {
 public:
  SmashProbe(const Scene& scene, double at)
      : at_(at),
        up_(upOf(scene)),
        ground_(groundHeight(scene)),
        bricks_(watch(scene, dynamicBodies(scene))),
        top_(watch(scene, topLayer(scene))) {}

  void start(const World& world) override {
    begin(bricks_, world);
    begin(top_, world);
  }

  void finish(const World& world, Metrics& metrics) override {
    if (!reached(world, at_ + world.params().dt)) return;
    const Displacement all = displacement(world, bricks_, up_);
    metrics["smash_moved_ratio"] = double(all.moved) / double(bricks_.size());
    metrics["smash_lowest_m"] = all.lowestPoint - ground_;
    metrics["smash_top_drop_m"] = displacement(world, top_, up_).meanDrop;
  }

 private:
  double at_;
  Vec3 up_;
  double ground_;
  std::vector<Watched> bricks_, top_;
};

class FallProbe final : public Probe {
 public:
  FallProbe(const Scene& scene, double at, double duration)
      : at_(at),
        duration_(duration),
        up_(upOf(scene)),
        gravity_(length(scene.gravity)),
        bodies_(watch(scene, dynamicBodies(scene))) {
    const std::vector<int> top = topLayer(scene);
    isTop_.resize(bodies_.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      isTop_[i] = std::find(top.begin(), top.end(), bodies_[i].sceneIndex) != top.end();
  }

  void start(const World& world) override { begin(bodies_, world); }

  void afterStep(const World& world, const StepReport&) override {
    if (phase_ == Phase::Before && reached(world, at_)) {
      for (Watched& body : bodies_) body.start = world.state(body.id).position;
      startStep_ = world.stepCount();
      phase_ = Phase::Falling;
    } else if (phase_ == Phase::Falling && reached(world, at_ + duration_)) {
      measure(world);
      phase_ = Phase::Done;
    }
  }

  void finish(const World&, Metrics& metrics) override { metrics.insert(metrics_.begin(), metrics_.end()); }

 private:
  void measure(const World& world) {
    const Params& params = world.params();
    const double n = double(world.stepCount() - startStep_) * params.substeps;
    const double h = params.dt / params.substeps;
    const double freeFall = gravity_ * h * h * n * (n + 1) / 2;
    double sum = 0, topSum = 0, least = std::numeric_limits<double>::infinity(), bottom = 0;
    double lowest = std::numeric_limits<double>::infinity();
    std::size_t tops = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const double fall = dot(bodies_[i].start - world.state(bodies_[i].id).position, up_) / freeFall;
      sum += fall;
      least = std::min(least, fall);
      if (isTop_[i]) topSum += fall, ++tops;
      const double height = dot(bodies_[i].start, up_);
      if (height < lowest) lowest = height, bottom = fall;
    }
    const double top = topSum / double(tops);
    metrics_["fall_ratio"] = top;
    metrics_["fall_ratio_mean"] = sum / double(bodies_.size());
    metrics_["fall_ratio_bottom"] = bottom;
    metrics_["fall_ratio_ends"] = (top + bottom) / 2;
    metrics_["fall_ratio_min"] = least;
  }

  enum class Phase { Before, Falling, Done };
  double at_, duration_;
  Vec3 up_;
  double gravity_;
  std::vector<Watched> bodies_;
  std::vector<bool> isTop_;
  std::int64_t startStep_ = 0;
  Phase phase_ = Phase::Before;
  Metrics metrics_;
};

class ChainProbe final : public Probe {
 public:
  explicit ChainProbe(double chainLength) : length_(chainLength) {}

  void afterStep(const World& world, const StepReport&) override {
    peak_ = std::max(peak_, gapSum(world) / length_);
  }

  void finish(const World& world, Metrics& metrics) override {
    metrics["stretch"] = gapSum(world) / length_;
    metrics["stretch_peak"] = peak_;
  }

 private:
  static double gapSum(const World& world) {
    double sum = 0;
    for (const JointId id : world.joints()) sum += world.state(id).gap;
    return sum;
  }

  double length_;
  double peak_ = 0;
};

class EnergyProbe final : public Probe {
 public:
  explicit EnergyProbe(double scale) : scale_(scale) {}

  void start(const World& world) override { start_ = energy(world); }
  void afterStep(const World& world, const StepReport&) override {
    largest_ = std::max(largest_, (energy(world) - start_) / scale_);
  }

  void finish(const World& world, Metrics& metrics) override {
    metrics["energy_gain_ratio"] = largest_;
    metrics["energy_end_ratio"] = (energy(world) - start_) / scale_;
  }

 private:
  static double energy(const World& world) {
    const Quality quality = world.quality();
    return quality.kineticEnergy + quality.potentialEnergy;
  }

  double scale_;
  double start_ = 0;
  double largest_ = 0;
};

}  // namespace

std::vector<int> dynamicBodies(const Scene& scene) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].motion == Motion::Dynamic) indices.push_back(int(i));
  return indices;
}

std::vector<int> topLayer(const Scene& scene) {
  const Vec3 up = upOf(scene);
  const std::vector<int> bodies = dynamicBodies(scene);
  const auto height = [&](int i) { return dot(scene.bodies[std::size_t(i)].position, up); };
  double highest = -std::numeric_limits<double>::infinity();
  for (const int i : bodies) highest = std::max(highest, height(i));
  std::vector<int> top;
  for (const int i : bodies) {
    const BodyDef& body = scene.bodies[std::size_t(i)];
    if (height(i) > highest - .5 * reach(body.shape, body.orientation, up)) top.push_back(i);
  }
  return top;
}

std::unique_ptr<Probe> qualityProbe(double at, const std::string& prefix) {
  return std::make_unique<QualityProbe>(at, prefix);
}
std::unique_ptr<Probe> stackProbe(const Scene& scene, double at) {
  return std::make_unique<StackProbe>(scene, at);
}
std::unique_ptr<Probe> fallProbe(const Scene& scene, double at, double duration) {
  return std::make_unique<FallProbe>(scene, at, duration);
}
std::unique_ptr<Probe> chainProbe(const Scene&, double length) {
  return std::make_unique<ChainProbe>(length);
}
std::unique_ptr<Probe> energyProbe(double scale) { return std::make_unique<EnergyProbe>(scale); }

Probes smashProbes(const Scene& scene, double at) {
  Probes probes;
  probes.push_back(std::make_unique<SmashProbe>(scene, at));
  probes.push_back(qualityProbe(at + .5, "smash_"));
  return probes;
}

}  // namespace rubble::scenes
