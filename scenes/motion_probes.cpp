#include "motion_probes.h"

#include <algorithm>
#include <cmath>

#include "build.h"
#include "probe_parts.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

class KineticProbe final : public MomentProbe {
 public:
  KineticProbe(double at, std::string metric, double reference)
      : MomentProbe(at, true), metric_(std::move(metric)), reference_(reference) {}

 private:
  void measure(const World& world, Metrics& metrics) override {
    metrics[metric_] = world.quality().kineticEnergy / reference_;
  }

  std::string metric_;
  double reference_;
};

class SwingProbe final : public BodyProbe {
 public:
  SwingProbe(const std::string& body, const Vec3& direction) : BodyProbe(body), direction_(direction) {}

  void afterStep(const World& world, const StepReport&) override {
    if (time_ > 0) return;
    const double speed = dot(state(world).velocity, direction_);
    if (last_ < 0 && speed >= 0) time_ = world.time() - world.params().dt * speed / (speed - last_);
    last_ = speed;
  }
  void finish(const World&, Metrics& metrics) override {
    if (time_ > 0) metrics["swing_time_s"] = time_;
  }

 private:
  Vec3 direction_;
  double last_ = 0, time_ = 0;
};

class LengthProbe final : public MomentProbe {
 public:
  LengthProbe(std::string a, std::string b, double at)
      : MomentProbe(at), a_(std::move(a)), b_(std::move(b)) {}

 private:
  void measure(const World& world, Metrics& metrics) override {
    metrics["length_m"] = length(world.state(world.findBody(a_)).position -
                                 world.state(world.findBody(b_)).position);
  }

  std::string a_, b_;
};

class BallisticProbe final : public BodyProbe {
 public:
  BallisticProbe(const Scene& scene, const std::string& body) : BodyProbe(body), gravity_(scene.gravity) {}

  void afterStep(const World& world, const StepReport&) override {
    const double h = world.params().dt / world.params().substeps;
    const double n = double(world.stepCount()) * world.params().substeps;
    const Vec3 exact = first().position + n * h * first().velocity + h * h * n * (n + 1) / 2 * gravity_;
    const Vec3 now = state(world).position;
    way_ += length(now - last_);
    last_ = now;
    error_ = std::max(error_, length(now - exact));
  }
  void start(const World& world) override {
    BodyProbe::start(world);
    last_ = first().position;
  }
  void finish(const World&, Metrics& metrics) override { metrics["position_error_ratio"] = error_ / way_; }

 private:
  Vec3 gravity_, last_;
  double error_ = 0, way_ = 0;
};

class PeriodProbe final : public BodyProbe {
 public:
  PeriodProbe(const std::string& body, double period) : BodyProbe(body), period_(period) {}

  void start(const World& world) override {
    BodyProbe::start(world);
    last_ = first().position.x;
  }
  void afterStep(const World& world, const StepReport&) override {
    const double x = state(world).position.x;
    if (last_ < 0 && x >= 0) passages_.push_back(world.time() - world.params().dt * x / (x - last_));
    last_ = x;
  }
  void finish(const World&, Metrics& metrics) override {
    if (passages_.size() < 2) return;
    metrics["period_s"] = (passages_.back() - passages_.front()) / double(passages_.size() - 1);
    metrics["period_error"] = metrics["period_s"] / period_ - 1;
  }

 private:
  double period_;
  double last_ = 0;
  std::vector<double> passages_;  // [s]
};

class SpinProbe final : public BodyProbe {
 public:
  SpinProbe(const std::string& body, const Vec3& axis) : BodyProbe(body), axis_(axis) {}

  void start(const World& world) override {
    BodyProbe::start(world);
    inertia_ = world.massOf(id()).inertia;
  }
  void afterStep(const World& world, const StepReport&) override {
    const BodyState now = state(world);
    const Vec3 momentum = momentumOf(now, world.params().dt / world.params().substeps);
    const double energy = dot(momentum, now.angularVelocity);
    if (energy_ == 0) {
      momentum_ = momentum;
      energy_ = energy;
      side_ = dot(rotate(now.orientation, axis_), momentum_) > 0;
    }
    error_ = std::max(error_, length(momentum - momentum_) / length(momentum_));
    least_ = std::min(least_, energy / energy_);
    most_ = std::max(most_, energy / energy_);
    const bool side = dot(rotate(now.orientation, axis_), momentum_) > 0;
    flips_ += side != side_;
    side_ = side;
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["momentum_error"] = error_;
    metrics["energy_ratio"] = least_;
    metrics["energy_ratio_max"] = most_;
    metrics["flips"] = flips_;
  }

 private:
  /// The spin is that of the last step of h, so it belongs to the orientation in the middle of that step.
  Vec3 momentumOf(const BodyState& state, double h) const {
    const double speed = length(state.angularVelocity);
    const Quat middle = fromAxisAngle(normalize(state.angularVelocity), -.5 * h * speed) * state.orientation;
    return rotate(middle, mul(inertia_, rotateInverse(middle, state.angularVelocity)));
  }

  Vec3 axis_, inertia_, momentum_;
  double energy_ = 0, error_ = 0, least_ = 1, most_ = 1;
  bool side_ = true;
  int flips_ = 0;
};

class ImpactProbe final : public Probe {
 public:
  ImpactProbe(std::string a, std::string b) : a_(std::move(a)), b_(std::move(b)) {}

  void start(const World& world) override {
    momentum_ = momentum(world);
    closing_ = closing(world);
    direction_ = normalize(closing_);
  }
  void afterStep(const World& world, const StepReport&) override {
    error_ = std::max(error_, length(momentum(world) - momentum_) / length(momentum_));
  }
  void finish(const World& world, Metrics& metrics) override {
    metrics["momentum_error"] = error_;
    metrics["closing_speed_ratio"] = dot(closing(world), direction_) / length(closing_);
  }

 private:
  Vec3 momentum(const World& world) const {
    Vec3 sum;
    for (const std::string& name : {a_, b_}) {
      const BodyId id = world.findBody(name);
      sum += world.massOf(id).mass * world.state(id).velocity;
    }
    return sum;
  }
  Vec3 closing(const World& world) const {
    return world.state(world.findBody(a_)).velocity - world.state(world.findBody(b_)).velocity;
  }

  std::string a_, b_;
  Vec3 momentum_, closing_, direction_;
  double error_ = 0;
};

class ReboundProbe final : public BodyProbe {
 public:
  ReboundProbe(const Scene& scene, const std::string& body, double rest, double drop)
      : BodyProbe(body), up_(upOf(scene)), rest_(rest), drop_(drop) {}

  void afterStep(const World& world, const StepReport&) override {
    const BodyState now = state(world);
    const double speed = dot(now.velocity, up_);
    if (phase_ == 0 && speed > 0) phase_ = 1;
    if (phase_ == 1) apex_ = std::max(apex_, dot(now.position, up_) - rest_);
    if (phase_ == 1 && speed < 0) phase_ = 2;
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["restitution_found"] = std::sqrt(apex_ / drop_);
  }

 private:
  Vec3 up_;
  double rest_, drop_;
  int phase_ = 0;  // 0 falls, 1 rises, 2 over
  double apex_ = 0;
};

class FallenProbe final : public Probe {
 public:
  FallenProbe(const Scene& scene, const Vec3& local)
      : local_(local), bodies_(watch(scene, dynamicBodies(scene))) {}

  void start(const World& world) override {
    begin(bodies_, world);
    for (const Watched& body : bodies_) axes_.push_back(rotate(world.state(body.id).orientation, local_));
  }
  void finish(const World& world, Metrics& metrics) override {
    int fallen = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      fallen += dot(rotate(world.state(bodies_[i].id).orientation, local_), axes_[i]) < std::sqrt(.5);
    metrics["fallen_ratio"] = fallen / double(bodies_.size());
  }

 private:
  Vec3 local_;
  std::vector<Watched> bodies_;
  std::vector<Vec3> axes_;
};

}  // namespace

std::unique_ptr<Probe> kineticProbe(double at, const std::string& metric, double reference) {
  return std::make_unique<KineticProbe>(at, metric, reference);
}
std::unique_ptr<Probe> swingProbe(const std::string& body, const Vec3& direction) {
  return std::make_unique<SwingProbe>(body, direction);
}
std::unique_ptr<Probe> lengthProbe(const std::string& a, const std::string& b, double at) {
  return std::make_unique<LengthProbe>(a, b, at);
}
std::unique_ptr<Probe> ballisticProbe(const Scene& scene, const std::string& body) {
  return std::make_unique<BallisticProbe>(scene, body);
}
std::unique_ptr<Probe> periodProbe(const std::string& body, double period) {
  return std::make_unique<PeriodProbe>(body, period);
}
std::unique_ptr<Probe> spinProbe(const std::string& body, const Vec3& axis) {
  return std::make_unique<SpinProbe>(body, axis);
}
std::unique_ptr<Probe> impactProbe(const std::string& a, const std::string& b) {
  return std::make_unique<ImpactProbe>(a, b);
}
std::unique_ptr<Probe> reboundProbe(const Scene& scene, const std::string& body, double rest, double drop) {
  return std::make_unique<ReboundProbe>(scene, body, rest, drop);
}
std::unique_ptr<Probe> fallenProbe(const Scene& scene, const Vec3& local) {
  return std::make_unique<FallenProbe>(scene, local);
}

}  // namespace rubble::scenes
