/// Scenes of joints that grow to a hundred thousand rows and more. y up, g 9.81.
#include <algorithm>
#include <cmath>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr double kMesh = .5;              // from node to node of a quilt [m]
constexpr double kNodeRadius = .1;        // [m]
constexpr double kCubeDensityRatio = .1;  // density of what falls on a quilt over that of its nodes: a cube
                                          // weighs five nodes

// Quilts that catch cubes: after the scene of 35,000 bodies and 72,000 joints of the AVBD paper (Figure 14),
// without its cloth.

constexpr int kLayers = 2;          // of a quilt
constexpr double kHalfCube = .3;    // of what falls on it [m]
constexpr double kCubePitch = .65;  // [m]
constexpr double kClear = .3;       // between quilt and cubes at the start [m]

/// Two square nets of spheres on ball joints, one above the other and joined to it, held along two edges.
void addQuilt(Scene& scene, int size, double density, const Vec3& corner) {
  const int first = int(scene.bodies.size()), layer = size * size;
  for (int y = 0; y < kLayers; ++y)
    for (int row = 0; row < size; ++row)
      for (int column = 0; column < size; ++column) {
        BodyDef node;
        node.shape = Shape::sphere(kNodeRadius);
        node.density = density;
        node.position = corner + kMesh * Vec3{double(column), double(y), double(row)};
        const bool held = row == 0 || row + 1 == size;
        if (held) node.motion = Motion::Static;
        const int index = first + y * layer + row * size + column;
        const auto join = [&](int to, const Vec3& direction) {
          scene.joints.push_back(ballJoint(to, kMesh / 2 * direction, index, -kMesh / 2 * direction));
        };
        // a joint between two static spheres would do nothing
        if (column > 0 && !held) join(index - 1, {1, 0, 0});
        if (row > 0) join(index - size, {0, 0, 1});
        if (y > 0 && !held) join(index - layer, {0, 1, 0});
        scene.bodies.push_back(node);
      }
}

/// Cubes in layers, as wide as a third of the quilt.
void addCubes(Scene& scene, int count, int size, double density, const Vec3& corner) {
  const int edge = std::max(1, int(kMesh * size / (3 * kCubePitch)));
  const double middle = kMesh * (size - 1) / 2,
               low = kMesh * (kLayers - 1) + kNodeRadius + kClear + kHalfCube;
  for (int k = 0; k < count; ++k) {
    const int x = k % edge, z = k / edge % edge, y = k / (edge * edge);
    const Vec3 place{middle + kCubePitch * (x - .5 * (edge - 1)), low + kCubePitch * y,
                     middle + kCubePitch * (z - .5 * (edge - 1))};
    scene.bodies.push_back(block({kHalfCube, kHalfCube, kHalfCube}, corner + place, density));
  }
}

Scene buildQuilts(const Arguments& arguments) {
  const int quilts = whole(arguments, "quilts"), size = whole(arguments, "size"),
            cubes = whole(arguments, "cubes");
  const double density = value(arguments, "density");
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY, -value(arguments, "height")));
  const int side = int(std::ceil(std::sqrt(double(quilts))));
  const double pitch = kMesh * size + 2;
  for (int k = 0; k < quilts; ++k) {
    const Vec3 corner{pitch * (k % side), 0, pitch * (k / side)};
    addQuilt(scene, size, density, corner);
    addCubes(scene, cubes, size, kCubeDensityRatio * density, corner);
  }
  return scene;
}

Probes quiltProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(stackProbe(scene, kNoBound));
  return probes;
}

std::vector<Claim> quiltClaims(const Arguments& arguments) {
  return {atMost("joint_gap_mean_m", .01 * kMesh, "mean gap of a joint under 1 % of the mesh"),
          atLeast("lowest_m", value(arguments, "height") / 4, "nothing falls through the quilts"),
          atMost("broken_joints", 0, "every joint holds"),
          atMost("quarantined", 0, "every state stays finite")};
}

// Many chains.

constexpr double kLink = .5, kHalfWidth = .1;  // [m]

Scene buildChains(const Arguments& arguments) {
  const int chains = whole(arguments, "chains"), links = whole(arguments, "links");
  const double angle = value(arguments, "angle") * portable::acos(-1.0) / 180;
  const Vec3 along{portable::sin(angle), -portable::cos(angle), 0};
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.reserve(std::size_t(chains) * std::size_t(links));
  const int side = int(std::ceil(std::sqrt(double(chains))));
  const double pitchX = kLink * links * portable::sin(angle) + 1;
  for (int c = 0; c < chains; ++c) {
    const Vec3 top{pitchX * (c % side), 0, double(c / side)};
    for (int i = 0; i < links; ++i) {
      BodyDef link = block({kHalfWidth, kLink / 2, kHalfWidth}, top + kLink * (i + .5) * along,
                           value(arguments, "density"));
      link.orientation = fromAxisAngle(Vec3{0, 0, 1}, angle);
      const int index = int(scene.bodies.size());
      const bool first = i == 0;
      scene.joints.push_back(ballJoint(first ? kWorld : index - 1, first ? top : Vec3{0, -kLink / 2, 0},
                                       index, {0, kLink / 2, 0}));
      scene.bodies.push_back(link);
    }
  }
  return scene;
}

/// Potential energy that the chains can lose: that of their swing down [J].
double swingEnergy(const Arguments& arguments, const Scene& scene) {
  const double mass = 4 * kHalfWidth * kHalfWidth * kLink * value(arguments, "density") *
                      double(scene.bodies.size());
  return mass * length(scene.gravity) * whole(arguments, "links") * kLink / 2;
}

Probes chainsProbes(const Arguments& arguments, const Scene& scene) {
  Probes probes;
  probes.push_back(energyProbe(swingEnergy(arguments, scene)));
  return probes;
}

std::vector<Claim> chainsClaims(const Arguments&) {
  return {atMost("joint_gap_mean_m", .01 * kLink, "mean gap of a joint under 1 % of a link"),
          atMost("energy_gain_ratio", 1e-3, "they never gain energy"),
          atMost("broken_joints", 0, "every joint holds"),
          atMost("quarantined", 0, "every state stays finite")};
}

}  // namespace

std::vector<Spec> scaleSpecs() {
  const Argument density = quantity("density", 1000, 1e-3, 1e7, "kg/m3", "density of all bodies");
  Spec quilts;
  quilts.name = "quilt";
  quilts.doc = "A quilt of two nets of spheres on ball joints, held along two edges, that catches cubes.";
  quilts.arguments = {count("quilts", 1, 1, 1000, "quilts of two nets, one above the other"),
                      count("size", 31, 4, 300, "spheres along an edge of a net"),
                      count("cubes", 265, 0, 100000, "cubes over a quilt"),
                      quantity("height", 10, 1, 100, "m", "of the quilts above the ground"), density};
  quilts.build = buildQuilts;
  quilts.probes = quiltProbes;
  quilts.claims = quiltClaims;
  quilts.camera = overview;
  quilts.steps = 240;
  quilts.iterations = 4;
  quilts.testArguments = {{"quilts", 1}, {"size", 11}, {"cubes", 12}};
  quilts.tags = {"joint"};

  Spec chains = quilts;
  chains.name = "chains";
  chains.doc = "Chains of fifty links side by side, let go at an angle.";
  chains.arguments = {
      count("chains", 10, 1, 100000, "chains"), count("links", 50, 2, 1000, "links of a chain"),
      quantity("angle", 30, 0, 90, "degrees", "of the chains to the vertical at the start"), density};
  chains.build = buildChains;
  chains.probes = chainsProbes;
  chains.claims = chainsClaims;
  chains.testArguments = {{"chains", 3}, {"links", 20}};

  std::vector<Spec> specs{
      quilts, chains,
      variant(quilts, "joints-35k",
              "Sixteen quilts that catch 265 cubes each: 34,992 bodies, 71,984 joints (after Figure 14 of "
              "the AVBD paper, without its "
              "cloth).",
              {{"quilts", 16}}),
      variant(chains, "chains-1000x50",
              "A thousand chains of fifty links let go at 30 degrees: 50,000 bodies, 50,000 joints.",
              {{"chains", 1000}})};
  for (std::size_t k = 2; k < specs.size(); ++k) specs[k].tags.push_back("scale");
  return specs;
}

}  // namespace rubble::scenes
