/// Running-bond walls, the ring wall of Figure 1 and the gables of Figure 2 of the AVBD abstract. y up, g
/// 9.81. The single wall has z up, g 10.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr Vec3 kHalfBrick{.5, .25, .25};
constexpr double kHeight = 2 * kHalfBrick.y;  // of a course [m]

void shuffleIfAsked(const Arguments& arguments, Scene& scene) {
  if (whole(arguments, "shuffle") == 1) shuffleBodies(scene, 1);
}

bool smashes(const Arguments& arguments) { return whole(arguments, "smash") == 1; }

Probes probes(const Arguments& arguments, const Scene& scene) {
  Probes result;
  if (smashes(arguments)) result = smashProbes(scene, kSettleSeconds);
  result.push_back(stackProbe(scene, smashes(arguments) ? kSettleSeconds : kNoBound));
  return result;
}

std::vector<Claim> claims(const Arguments& arguments) {
  const Scale scale = scaleOf(arguments);
  const std::vector<Claim> stands = standsClaims(.05 * scale.length,
                                                 "the top course goes down under 50 mm at 4 iterations");
  if (smashes(arguments)) return stands + smashClaims(scale.length);
  return stands + std::vector<Claim>{atMost("max_speed_m_s", .05 * scale.speed, "it stands still")};
}

BodyDef ball(const std::string& name, double radius, double density, const Vec3& position,
             const Vec3& velocity) {
  BodyDef body;
  body.name = name;
  body.shape = Shape::sphere(radius);
  body.density = density;
  body.position = position;
  body.velocity = velocity;
  return body;
}

/// One wall along `along`, centered over `at`; half bricks close the odd courses, `gap` [m] between the
/// bricks of a course.
void addWall(Scene& scene, int bricks, int courses, double gap, const Vec3& along, const Vec3& up,
             const Vec3& at, const Vec3& halfBrick, const Scale& scale) {
  const double pitch = 2 * kHalfBrick.x + gap;
  const double length = bricks * pitch - gap;
  const Vec3 closer = halfBrick - (kHalfBrick.x - (pitch - 2 * gap) / 4) *
                                      along;  // half brick: two of them and a gap make one brick
  const auto place = [&](const Vec3& half, double x, int course) {
    scene.bodies.push_back(
        block(scale.length * half,
              scale.length * (at + (x - length / 2) * along + (course + .5) * kHeight * up), scale.density));
  };
  const double closerLength = 2 * dot(abs(closer), abs(along));
  for (int course = 0; course < courses; ++course) {
    if (course % 2 == 0) {
      for (int i = 0; i < bricks; ++i) place(halfBrick, kHalfBrick.x + i * pitch, course);
      continue;
    }
    place(closer, closerLength / 2, course);
    for (int i = 0; i + 1 < bricks; ++i) place(halfBrick, pitch / 2 + kHalfBrick.x + i * pitch, course);
    place(closer, length - closerLength / 2, course);
  }
}

// Many walls.

constexpr double kGap = .05;  // between bricks and between walls [m]

Scene buildWalls(const Arguments& arguments) {
  const int walls = whole(arguments, "walls"), bricks = whole(arguments, "bricks"),
            courses = whole(arguments, "courses");
  const Scale scale = scaleOf(arguments);
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.reserve(std::size_t(walls) * std::size_t(bricks + 1) * std::size_t(courses) + 1);
  scene.bodies.push_back(ground(kUpY));
  for (int i = 0; i < walls; ++i)
    addWall(scene, bricks, courses, kGap, {1, 0, 0}, kUpY,
            {0, 0, (i - .5 * (walls - 1)) * (2 * kHalfBrick.z + kGap)}, kHalfBrick, scale);
  shuffleIfAsked(arguments, scene);
  if (smashes(arguments)) {
    const double radius = value(arguments, "ball_radius");
    const double halfLength = (bricks * (2 * kHalfBrick.x + kGap) - kGap) / 2;
    addAt(scene, kSettleSteps,
          {ball("ball", scale.length * radius, 4 * scale.density,
                scale.length * Vec3{-(halfLength + radius + .5), std::max(radius, courses * kHeight / 2), 0},
                {30 * scale.speed, 0, 0})});
  }
  return scene;
}

// One wall, bricks end to end.

Scene buildWall(const Arguments& arguments) {
  const Scale scale = scaleOf(arguments);
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  addWall(scene, whole(arguments, "bricks"), whole(arguments, "courses"), value(arguments, "gap"), {1, 0, 0},
          kUpZ, {}, kHalfBrick, scale);
  setFriction(scene, .5);
  return scene;
}

Probes wallProbes(const Arguments&, const Scene& scene) {
  Probes result;
  result.push_back(stackProbe(scene, kNoBound));
  return result;
}

std::vector<Claim> wallClaims(const Arguments& arguments) {
  const Scale scale = scaleOf(arguments);
  return standsClaims(.05 * scale.length, "the top course goes down under 50 mm at 4 iterations") +
         std::vector<Claim>{atMost("max_speed_m_s", .05 * scale.speed, "it stands still")};
}

// The ring wall.

constexpr double kRingGap = .02;   // between bricks of a row at their inner faces [m]
constexpr double kRowPitch = .52;  // [m]

/// Bricks of a row whose inner faces are `inner` from the axis.
int ringBricks(double inner) {
  return int(std::numbers::pi / portable::atan((kHalfBrick.x + kRingGap / 2) / inner));
}

Scene buildRing(const Arguments& arguments) {
  const int courses = whole(arguments, "courses"), rows = whole(arguments, "rows");
  const double radius = value(arguments, "radius");
  const Scale scale = scaleOf(arguments);
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY));
  for (int course = 0; course < courses; ++course) {
    const int rowsHere = rows - course * rows / courses;
    for (int row = 0; row < rowsHere; ++row) {
      const double inner = radius + row * kRowPitch;
      const int bricks = ringBricks(inner);
      for (int i = 0; i < bricks; ++i) {
        const double angle = 2 * std::numbers::pi * (i + (course % 2 == 1 ? .5 : 0)) / bricks;
        const double r = inner + kHalfBrick.z;
        BodyDef brick = block(
            scale.length * kHalfBrick,
            scale.length * Vec3{r * portable::sin(angle), (course + .5) * kHeight, r * portable::cos(angle)},
            scale.density);
        brick.orientation = fromAxisAngle(kUpY, angle);
        scene.bodies.push_back(brick);
      }
    }
  }
  shuffleIfAsked(arguments, scene);
  if (smashes(arguments)) {
    const double ballRadius = value(arguments, "ball_radius");
    addAt(scene, kSettleSteps,
          {ball("ball", scale.length * ballRadius, 10 * scale.density,
                scale.length * Vec3{radius - ballRadius - .5, std::max(ballRadius, courses * kHeight / 2), 0},
                {30 * scale.speed, 0, 0})});
  }
  return scene;
}

// Gables.

constexpr double kGableDistance = 2;  // between neighbors, both ways [m]

Scene buildGables(const Arguments& arguments) {
  const int nx = whole(arguments, "nx"), nz = whole(arguments, "nz"), courses = whole(arguments, "courses");
  const Scale scale = scaleOf(arguments);
  const double pitch = 2 * kHalfBrick.x + kGap;
  const double pitchX = courses * pitch - kGap + kGableDistance, pitchZ = kGableDistance;
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.reserve(
      std::size_t(nx) * std::size_t(nz) * std::size_t(courses) * std::size_t(courses + 1) / 2 + 1);
  scene.bodies.push_back(ground(kUpY));
  for (int ix = 0; ix < nx; ++ix)
    for (int iz = 0; iz < nz; ++iz)
      for (int course = 0; course < courses; ++course)
        for (int i = 0; i < courses - course; ++i) {
          const Vec3 position{(ix - .5 * (nx - 1)) * pitchX + (i - .5 * (courses - course - 1)) * pitch,
                              (course + .5) * kHeight, (iz - .5 * (nz - 1)) * pitchZ};
          scene.bodies.push_back(block(scale.length * kHalfBrick, scale.length * position, scale.density));
        }
  shuffleIfAsked(arguments, scene);
  if (smashes(arguments)) {
    const double radius = value(arguments, "ball_radius");
    const double z = nz * pitchZ / 2 + radius;
    std::vector<BodyDef> balls;
    for (const double side : {-1.0, 1.0})
      balls.push_back(ball(side < 0 ? "ball0" : "ball1", scale.length * radius, 50 * scale.density,
                           scale.length * Vec3{side * nx * pitchX / 4, radius + .5, -z},
                           {0, 0, 30 * scale.speed}));
    addAt(scene, kSettleSteps, balls);
  }
  return scene;
}

}  // namespace

std::vector<Spec> wallSpecs() {
  const Argument smash = flag("smash", true, "1: the ball comes after 2 s");
  const Argument shuffle = flag("shuffle", false, "1: the bricks are added in random order");
  Spec walls;
  walls.name = "walls";
  walls.doc = "Running-bond walls of 40 courses side by side, two contacts per brick, a ball from one end.";
  walls.arguments = stackArguments(
      {count("walls", 4, 1, 20000, "walls side by side"), count("bricks", 40, 2, 1000, "bricks in a course"),
       count("courses", 40, 1, 200, "courses of a wall"), smash, shuffle,
       quantity("ball_radius", 2.5, .2, 20, "m", "radius of the ball, four times as dense as a brick")});
  walls.build = buildWalls;
  walls.probes = probes;
  walls.claims = claims;
  walls.camera = overview;
  walls.steps = 240;
  walls.iterations = 4;
  walls.smashStep = kSettleSteps;
  walls.testArguments = {{"walls", 2}, {"bricks", 6}, {"courses", 10}, {"ball_radius", 1}};
  walls.testSteps = 240;
  walls.tags = {"stack", "smash"};

  Spec wall = walls;
  wall.name = "wall";
  wall.doc = "One running-bond wall, bricks touching end to end, left alone for 10 s.";
  wall.arguments = stackArguments(
      {count("bricks", 20, 2, 1000, "bricks in a course"), count("courses", 10, 1, 200, "courses"),
       quantity("gap", 0, 0, .2, "m", "between the bricks of a course")},
      1);
  wall.build = buildWall;
  wall.probes = wallProbes;
  wall.claims = wallClaims;
  wall.steps = 600;
  wall.smashStep = -1;
  wall.testArguments = {{"bricks", 8}, {"courses", 10}};
  wall.tags = {"stack"};

  Spec ring = walls;
  ring.name = "ring";
  ring.doc =
      "The pile of Figure 1 of the AVBD abstract: a ring wall, sheer inside, stepped outside, smashed from "
      "inside.";
  ring.arguments = stackArguments(
      {quantity("radius", 13.45, 6, 2000, "m", "inner radius of the wall"),
       count("rows", 2, 1, 40, "rows of bricks at the base"),
       count("courses", 40, 1, 200, "courses; the wall loses its rows evenly on the way up"),
       quantity("ball_radius", 2.5, .2, 20, "m", "radius of the ball, ten times as dense as a brick"), smash,
       shuffle});
  ring.build = buildRing;
  ring.steps = 600;
  ring.testArguments = {{"radius", 6}, {"rows", 2}, {"courses", 10}, {"ball_radius", 1}};

  Spec gables = walls;
  gables.name = "gables";
  gables.doc =
      "The walls of Figure 2 of the AVBD abstract: a field of triangular walls one brick thick, smashed by "
      "two balls.";
  gables.arguments = stackArguments(
      {count("nx", 2, 1, 200, "gables along x"), count("nz", 6, 1, 500, "gables along z, 2 m apart"),
       count("courses", 30, 1, 100, "courses; as many bricks in the lowest one"),
       quantity("ball_radius", 4.3, .2, 20, "m", "radius of the balls, fifty times as dense as a brick"),
       smash, shuffle});
  gables.build = buildGables;
  gables.steps = 600;
  gables.testArguments = {{"nx", 2}, {"nz", 2}, {"courses", 8}, {"ball_radius", 1}};

  std::vector<Spec> specs{
      wall,
      variant(wall, "heavy-wall", "One wall of 20 courses of 40 bricks, 10 s.",
              {{"bricks", 40}, {"courses", 20}}),
      variant(wall, "wall-40", "One wall of 40 courses of 20 bricks, 10 s.",
              {{"bricks", 20}, {"courses", 40}}),
      walls,
      ring,
      variant(ring, "ring-5k-hold", "The ring wall of 5,000 bricks left alone for 10 s.", {{"smash", 0}}),
      gables};
  const auto large = [&](const Spec& base, const std::string& name, const std::string& doc,
                         const Arguments& defaults) {
    specs.push_back(variant(base, name, doc, defaults, 240));
    specs.back().tags.push_back("scale");
  };
  large(walls, "walls-110k", "68 walls of 1,620 bricks: 110,160, smashed.", {{"walls", 68}});
  large(walls, "walls-510k", "315 walls of 1,620 bricks: 510,300, smashed.", {{"walls", 315}});
  large(walls, "walls-1m", "648 walls of 1,620 bricks: 1,049,760, smashed.", {{"walls", 648}});
  large(walls, "walls-2m", "1,235 walls of 1,620 bricks: 2,000,700, smashed.", {{"walls", 1235}});
  // of so many a ball as usual moves fewer than one in a hundred
  large(walls, "walls-4m", "2,470 walls of 1,620 bricks: 4,001,400, smashed.",
        {{"walls", 2470}, {"ball_radius", 4}});
  large(ring, "ring-5k", "The ring wall at 40 courses, 2 rows and 5,000 bricks, smashed.", {});
  large(ring, "ring-110k", "The ring wall of 110,000 bricks, 40 courses, 10 rows, 160 m across, smashed.",
        {{"radius", 79.7}, {"rows", 10}, {"ball_radius", 8}});
  large(ring, "ring-1m", "The ring wall of 999,942 bricks, 40 courses, 34 rows, 480 m across, smashed.",
        {{"radius", 221}, {"rows", 34}, {"ball_radius", 20}});
  large(gables, "gables-510k", "16 x 68 gables of 465 bricks: 505,920, smashed.", {{"nx", 16}, {"nz", 68}});
  large(gables, "gables-510k-shuffled", "The same, with bricks added in random order.",
        {{"nx", 16}, {"nz", 68}, {"shuffle", 1}});
  return specs;
}

}  // namespace rubble::scenes
