/// Solids of tetrahedra never gain energy, at any number of iterations: kinetic, elastic and gravity's
/// together stay below what they began with.
#include <gtest/gtest.h>

#include "tests/soft/soft_scenes.h"

namespace rubble {
namespace {

using namespace test;

struct Case {
  TetSolidDef def;
  Vec3 gravity;
  double dt;
  int iterations;
};

enum class Hold { Side, Top, Free, Spinning };

/// A solid of 2 to 12 cells by up to 3 by up to 4, held or free, at rest or squashed.
Case randomCase(unsigned seed) {
  Random random(seed);
  const Hold hold = static_cast<Hold>(random.below(4));
  const double cell = random.logUniform(.01, .3);
  const int along = 2 + random.below(11), wide = 1 + random.below(3), high = 1 + random.below(4);
  Case c;
  c.def = tetBox({0, 0, 0}, {along * cell, wide * cell, high * cell * random.uniform(.5, 1.5)},
                 {along, wide, high});
  TetSolidDef& d = c.def;
  d.youngsModulus = random.logUniform(1e4, 1e8), d.poissonRatio = random.uniform(.1, .45),
  d.density = random.logUniform(100, 3000);
  c.dt = 1 / random.logUniform(30, 240), c.iterations = 1 + random.below(20);
  const bool isFree = hold == Hold::Free || hold == Hold::Spinning;
  c.gravity = {0, 0, isFree ? 0. : -10.};
  if (hold == Hold::Spinning) d.angularVelocity = random.vector(6);
  const double squash = isFree || random.below(2) == 0 ? random.uniform(.7, 1.2) : 1;
  const double top = d.vertices.back().z;
  for (std::size_t i = 0; i < d.vertices.size(); ++i) {
    const Vec3& x = d.vertices[i];
    if (hold == Hold::Side && x.x == 0) d.fixed.push_back(static_cast<int>(i));
    if (hold == Hold::Top && x.z == top) d.fixed.push_back(static_cast<int>(i));
    d.start.push_back(hold == Hold::Side ? Vec3{squash * x.x, x.y, x.z}
                                         : Vec3{x.x, x.y, top + squash * (x.z - top)});
  }
  return c;
}

/// psi V of a tetrahedron of stable neo-Hookean material, 0 at rest.
double elasticEnergy(const TetSolidDef& d, const std::array<int, 4>& t, const std::vector<Vec3>& now) {
  const auto edge = [&](const std::vector<Vec3>& x, std::size_t k) {
    return x[static_cast<std::size_t>(t[k])] - x[static_cast<std::size_t>(t[0])];
  };
  const Vec3 a = edge(d.vertices, 1), b = edge(d.vertices, 2), c = edge(d.vertices, 3);
  const double volume = dot(a, cross(b, c));
  const Vec3 m1 = cross(b, c) / volume, m2 = cross(c, a) / volume, m3 = cross(a, b) / volume;
  const auto column = [&](double x, double y, double z) {
    return edge(now, 1) * x + edge(now, 2) * y + edge(now, 3) * z;
  };
  const Vec3 f0 = column(m1.x, m2.x, m3.x), f1 = column(m1.y, m2.y, m3.y), f2 = column(m1.z, m2.z, m3.z);
  const double mu = d.youngsModulus / (2 * (1 + d.poissonRatio));
  const double lambda = d.youngsModulus * d.poissonRatio / ((1 + d.poissonRatio) * (1 - 2 * d.poissonRatio)) +
                        mu,
               rest = 1 + mu / lambda;
  const double j = dot(f0, cross(f1, f2)) - rest;
  return volume / 6 *
         (mu / 2 * (dot(f0, f0) + dot(f1, f1) + dot(f2, f2) - 3) +
          lambda / 2 * (j * j - (1 - rest) * (1 - rest)));
}

struct Energies {
  double kinetic = 0, elastic = 0, gravity = 0;
  double sum() const { return kinetic + elastic + gravity; }
};
Energies energiesOf(const World& world) {
  const DeformableId id = world.deformableAt(0);
  const TetSolidDef& d = std::get<TetSolidDef>(world.definition(id));
  const std::vector<Vec3> x = world.positions(id), v = world.velocities(id);
  const std::vector<double> m = world.masses(id);
  Energies e;
  for (std::size_t i = 0; i < x.size(); ++i) {
    e.kinetic += m[i] * dot(v[i], v[i]) / 2;
    e.gravity -= m[i] * dot(world.gravity(), x[i] - d.vertices[i]);
  }
  for (const auto& t : d.tetrahedra) e.elastic += elasticEnergy(d, t, x);
  return e;
}

/// Largest energy in a run over what it began with, as a share of all that changed hands.
double risenBy(const Case& c, double seconds) {
  WorldOptions how = options(c.iterations);
  how.params.dt = c.dt;
  World world(sceneWith(c.def, c.gravity), how);
  const Energies start = energiesOf(world);
  double size = start.kinetic + start.elastic, risen = 0;
  for (int i = 0; i < seconds / c.dt; ++i) {
    world.step();
    const Energies e = energiesOf(world);
    size = std::max({size, e.kinetic, e.elastic, std::fabs(e.gravity)});
    risen = std::max(risen, e.sum() - start.sum());
  }
  return size > 0 ? risen / size : 0;
}

TEST(Energy, NeverGrowsHoweverASolidIsHeldAndSolved) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Case c = randomCase(seed);
    EXPECT_LT(risenBy(c, 1.5), .01) << "seed " << seed << ", " << c.iterations << " iterations, dt " << c.dt
                                    << " s, E " << c.def.youngsModulus;
  }
}

TEST(Energy, SpinOfASquashedBallIsKept) {
  for (const auto& [iterations, tolerance] : {std::pair{4, .05}, {20, .005}})
    for (const double spin : {1., 4.}) {
      TetSolidDef ball = tetBall({0, 0, 0}, .2, 4);
      ball.youngsModulus = 1e5;
      for (const Vec3& x : ball.vertices) ball.start.push_back({x.x, x.y, .8 * x.z});
      ball.angularVelocity = {0, 0, spin};
      World world(sceneWith(ball, {0, 0, 0}), options(iterations));
      const double before = momentumOf(world, world.deformableAt(0)).angular.z;
      run(world, 120);
      EXPECT_NEAR(momentumOf(world, world.deformableAt(0)).angular.z, before, tolerance * before)
          << spin << " rad/s, " << iterations << " iterations";
    }
}

TEST(Energy, OfACantileverOfManyCellsNeverGrows) {
  for (const int high : {4, 8})
    for (const int iterations : {2, 4, 6}) {
      Case c{tetBox({0, 0, 0}, {1, .1, .1}, {40, 2, high}), {0, 0, -10}, 1. / 60, iterations};
      c.def.youngsModulus = 5e6, c.def.poissonRatio = .3;
      for (std::size_t i = 0; i < c.def.vertices.size(); ++i)
        if (c.def.vertices[i].x == 0) c.def.fixed.push_back(static_cast<int>(i));
      EXPECT_LT(risenBy(c, 2), .001) << high << " cells, " << iterations << " iterations";
    }
}

}  // namespace
}  // namespace rubble
