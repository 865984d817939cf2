#pragma once
/// Probes for scenes of joints, and functions that build such scenes.
#include <functional>
#include <memory>
#include <string>

#include "build.h"

namespace rubble::scenes {

/// Called after each step; writes into the metrics of the run.
using Measure = std::function<void(const World&, const StepReport&, Metrics&)>;
std::unique_ptr<Probe> everyStep(Measure measure);
/// Called once, at the end.
std::unique_ptr<Probe> atEnd(std::function<void(const World&, Metrics&)> measure);

/// Keeps the largest value that a metric ever had.
void raise(Metrics& metrics, const std::string& name, double value);

/// joint_gap_peak_m, joint_angle_peak_deg: largest error of any joint in the run, after `from` seconds.
std::unique_ptr<Probe> jointErrorProbe(double from = 0);

/// State of a joint by name.
JointState jointOf(const World& world, const std::string& name);
BodyState bodyOf(const World& world, const std::string& name);

// Building.
/// Adds a body with a name; returns its index.
int put(Scene& scene, BodyDef body, const std::string& name = "");
BodyDef box(const Vec3& halfExtents, const Vec3& position, double mass);
BodyDef ball(double radius, const Vec3& position, double mass);
/// A capsule between two points.
BodyDef rod(const Vec3& a, const Vec3& b, double radius, double mass);
/// Adds jointAt() with a name and an axis (its frame's x); returns it for more.
JointDef& join(Scene& scene, JointType type, int a, int b, const Vec3& point, const Vec3& axis = {1, 0, 0},
               const std::string& name = "");

/// The same body, static.
BodyDef held(BodyDef body);
/// A joint of two bodies by index; anchors are at their centers.
JointDef link(JointType type, int a, int b);
/// A motor on an axis, with its largest force.
JointAxis motor(double speed, double most = kHard);

/// A scene of joints: claims at every size, and that every state stays finite; 4 iterations.
Spec jointSpec(const std::string& name, const std::string& doc, Scene (*build)(const Arguments&),
               Probes (*probes)(const Arguments&, const Scene&), std::vector<Claim> claims, int steps,
               std::vector<Argument> arguments = {});

}  // namespace rubble::scenes
