/// Properties of all elements between vertices. The force is minus the gradient of the energy. The Hessian
/// is the derivative of the force, or a definite part of it where the element says so. Forces have no net
/// force or moment and rotate with the element.
#include <gtest/gtest.h>

#include "forces/soft_forces.h"
#include "tests/support/core.h"
#include "tests/support/eigen.h"
#include "tests/support/random.h"
#include "tests/support/typed.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// An element with constants at rest, and the place of its corners at rest.
template <class F> struct Case {
  F element{};
  Vec3 rest[F::kCorners];
};

/// Of an element that a program adds: with the constants that it has by default.
template <class F> Case<F> makeCase(Random& random, Real) {
  Case<F> c;
  c.element.set(typename F::Model{});
  for (Vec3& p : c.rest) p = random.vector(.1);
  return c;
}

template <> Case<Tetrahedron> makeCase(Random& random, Real damping) {
  Case<Tetrahedron> c;
  Vec3* const x = c.rest;
  x[0] = {0, 0, 0}, x[1] = {.1, 0, 0}, x[2] = {.02, .12, 0}, x[3] = {.03, .02, .09};
  for (Vec3& p : c.rest) p += random.vector(.01);
  const Vec3 e1 = x[1] - x[0], e2 = x[2] - x[0], e3 = x[3] - x[0];
  const Real det = dot(e1, cross(e2, e3));
  Tetrahedron& t = c.element;
  t.m[0] = cross(e2, e3) / det, t.m[1] = cross(e3, e1) / det, t.m[2] = cross(e1, e2) / det;
  const Real volume = det / 6;
  t.mu = 4e4 * volume, t.lambda = 2e5 * volume;
  t.damper = damping * 300 * volume;
  return c;
}
template <> Case<Membrane> makeCase(Random& random, Real damping) {
  Case<Membrane> c;
  c.rest[0] = {0, 0, 0}, c.rest[1] = {.1, 0, 0}, c.rest[2] = {.03, .08, 0};
  Membrane& t = c.element;
  t.m1[0] = 10, t.m1[1] = -.03 / (.1 * .08), t.m2[0] = 0, t.m2[1] = 1 / .08;
  t.stiffness[0] = .004 * 900, t.stiffness[1] = .004 * 400;
  t.damper = damping * .004 * .05;
  t.unit0 = 1e-6;
  for (Real& l : t.lambda) l = random.uniform(-.2, .2);
  return c;
}
template <int N> void setBend(QuadraticBend<N>& b, Random& random) {
  b.stiffness = 3;
  Real sum = 0;
  for (int i = 1; i < N; ++i) sum += b.weight[i] = random.uniform(-2, 2);
  b.weight[0] = -sum;
}
template <> Case<FlatBend> makeCase(Random& random, Real) {
  Case<FlatBend> c;
  setBend<4>(c.element, random);
  for (Vec3& p : c.rest) p = random.vector(.1);
  return c;
}
template <> Case<LineBend> makeCase(Random& random, Real) {
  Case<LineBend> c;
  setBend<3>(c.element, random);
  for (Vec3& p : c.rest) p = random.vector(.1);
  return c;
}
template <> Case<FoldBend> makeCase(Random& random, Real damping) {
  Case<FoldBend> c;
  c.rest[0] = {0, 0, 0}, c.rest[1] = {.1, 0, 0}, c.rest[2] = {.04, .09, .02}, c.rest[3] = {.05, -.07, .04};
  for (Vec3& p : c.rest) p += random.vector(.01);
  c.element.stiffness = 2, c.element.damping = damping * .01, c.element.restAngle = .4;
  return c;
}
template <> Case<Spring> makeCase(Random& random, Real damping) {
  Case<Spring> c;
  c.rest[0] = {0, 0, 0}, c.rest[1] = random.vector(.3) + Vec3{.5, 0, 0};
  c.element.stiffness = 1000, c.element.damping = damping * 5, c.element.restLength = .4, c.element.mass = .1,
  c.element.bound = 1e30;
  c.element.lambda = random.uniform(-5, 20);
  return c;
}

/// Begun at rest and moved by up to `size`.
template <class F> struct Moved {
  F element;
  Vec3 x[F::kCorners];
};
template <class F> Moved<F> moved(Random& random, Real damping, Real size) {
  Case<F> c = makeCase<F>(random, damping);
  Moved<F> m;
  m.element = c.element;
  m.element.begin(testConstants(), c.rest);
  for (int k = 0; k < F::kCorners; ++k) m.x[k] = c.rest[k] + random.vector(size);
  return m;
}

template <class F> Block3 stamped(const F& e, const Vec3 (&x)[F::kCorners], int corner) {
  Block3 b;
  e.accumulate(testConstants(), x, corner, b);
  return b;
}

template <class F> class Element : public testing::Test {};
/// All but loads, whose forces on one element do not add up to nothing.
template <class List> struct InnerOf;
template <class... F> struct InnerOf<TypeList<F...>> {
  using List = typename SelectLoads<false, TypeList<>, F...>::Type;
};
TYPED_TEST_SUITE(Element, test::AsTypes<InnerOf<ElementTypes>::List>::Types);

TYPED_TEST(Element, ForceIsMinusTheGradientOfTheEnergy) {
  Random random(1);
  for (int n = 0; n < 40; ++n) {
    auto m = moved<TypeParam>(random, n % 2, .02);
    for (int corner = 0; corner < TypeParam::kCorners; ++corner) {
      const Vec3 force = stamped(m.element, m.x, corner).f;
      const Real scale = 1 + length(force);
      for (int axis = 0; axis < 3; ++axis) {
        constexpr Real h = 1e-6;
        const auto at = [&](Real s) {
          const Vec3 kept = m.x[corner];
          m.x[corner][axis] += s * h;
          const Real e = m.element.energy(testConstants(), m.x);
          m.x[corner] = kept;
          return e;
        };
        EXPECT_NEAR(force[axis], -(at(1) - at(-1)) / (2 * h), 1e-5 * scale) << corner << " " << axis;
      }
    }
  }
}

/// Is the Hessian the whole second derivative? Springs in tension and sheets under tension have it, and so do
/// tetrahedra without viscosity.
template <class F>
constexpr bool kCompleteHessian = std::is_same_v<F, Tetrahedron> || std::is_same_v<F, FlatBend> ||
                                  std::is_same_v<F, LineBend>;

TYPED_TEST(Element, HessianIsTheDerivativeOfTheForceWhereItIsComplete) {
  if constexpr (kCompleteHessian<TypeParam> || std::is_same_v<TypeParam, Spring> ||
                std::is_same_v<TypeParam, Membrane>) {
    Random random(2);
    for (int n = 0; n < 40; ++n) {
      auto m = moved<TypeParam>(random, 0, .02);
      if constexpr (std::is_same_v<TypeParam, Spring>)
        if (m.element.evaluate(testConstants(), m.x).force <= 0) continue;
      if constexpr (std::is_same_v<TypeParam, Membrane>) m.element.lambda[0] = 5;
      for (int corner = 0; corner < TypeParam::kCorners; ++corner) {
        const Sym3 h = stamped(m.element, m.x, corner).h;
        const Real scale = 1 + h.xx + h.yy + h.zz;
        for (int axis = 0; axis < 3; ++axis) {
          constexpr Real step = 1e-6;
          const auto at = [&](Real s) {
            const Vec3 kept = m.x[corner];
            m.x[corner][axis] += s * step;
            const Vec3 f = stamped(m.element, m.x, corner).f;
            m.x[corner] = kept;
            return f;
          };
          const Vec3 derivative = (at(1) - at(-1)) * (-1 / (2 * step));
          EXPECT_LT(length(derivative - h.column(axis)), 1e-5 * scale) << corner << " " << axis;
        }
      }
    }
  }
}

TYPED_TEST(Element, HessianIsPositiveSemidefiniteHoweverItIsDeformed) {
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    auto m = moved<TypeParam>(random, n % 2, n % 3 == 0 ? 3. : .1);
    for (int corner = 0; corner < TypeParam::kCorners; ++corner) {
      const Sym3 h = stamped(m.element, m.x, corner).h;
      Eigen::Matrix3d a;
      a << h.xx, h.xy, h.xz, h.xy, h.yy, h.yz, h.xz, h.yz, h.zz;
      const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(a).eigenvalues()(0);
      EXPECT_GE(least, -1e-9 * (1 + a.norm())) << corner;
    }
  }
}

TYPED_TEST(Element, ForcesHaveNoNetForceAndNoNetMoment) {
  Random random(4);
  for (int n = 0; n < 40; ++n) {
    // viscosity and dampers too
    auto m = moved<TypeParam>(random, n % 2, .05);
    Vec3 force{}, moment{};
    Real size = 1;
    for (int corner = 0; corner < TypeParam::kCorners; ++corner) {
      const Vec3 f = stamped(m.element, m.x, corner).f;
      force += f, moment += cross(m.x[corner], f);
      size += length(f);
    }
    EXPECT_LT(length(force), 1e-11 * size);
    EXPECT_LT(length(moment), 1e-11 * size);
  }
}

TYPED_TEST(Element, ATurnedElementGivesTurnedForces) {
  Random random(5);
  for (int n = 0; n < 20; ++n) {
    const auto m = moved<TypeParam>(random, n % 2, .05);
    const Quat q = random.rotation();
    Vec3 turned[TypeParam::kCorners];
    for (int k = 0; k < TypeParam::kCorners; ++k) turned[k] = rotate(q, m.x[k]) + Vec3{3, -2, 1};
    for (int corner = 0; corner < TypeParam::kCorners; ++corner) {
      const Vec3 a = rotate(q, stamped(m.element, m.x, corner).f), b = stamped(m.element, turned, corner).f;
      EXPECT_LT(length(a - b), 1e-9 * (1 + length(a))) << corner;
    }
  }
}

TYPED_TEST(Element, RestsInItsRestShapeAndHasNoViscousForceInARigidMotion) {
  if constexpr (std::is_same_v<TypeParam, Tetrahedron> || std::is_same_v<TypeParam, Membrane>) {
    Random random(6);
    for (int n = 0; n < 20; ++n) {
      Case<TypeParam> c = makeCase<TypeParam>(random, 1);
      if constexpr (TypeParam::kHasDual)
        for (Real& l : c.element.lambda) l = 0;
      c.element.begin(testConstants(), c.rest);
      const Quat q = random.rotation();
      Vec3 x[TypeParam::kCorners];
      for (int k = 0; k < TypeParam::kCorners; ++k) x[k] = rotate(q, c.rest[k]);
      for (int corner = 0; corner < TypeParam::kCorners; ++corner)
        EXPECT_LT(length(stamped(c.element, x, corner).f), 1e-8);
    }
  }
}

TEST(Tetrahedron, HasTheSmallStrainLimitOfLame) {
  // psi -> mu |eps|^2 + lam_L/2 tr(eps)^2 with lam_L = lam - mu
  Random random(7);
  const Case<Tetrahedron> c = makeCase<Tetrahedron>(random, 0);
  const Real mu = c.element.mu, lame = c.element.lambda - mu;
  const Vec3 none[4] = {c.rest[0], c.rest[1], c.rest[2], c.rest[3]};
  const Real atRest = c.element.energy(testConstants(), none);
  for (int n = 0; n < 10; ++n) {
    constexpr Real kSmall = 1e-4;
    const Vec3 a = random.vector(kSmall), b = random.vector(kSmall);
    const Sym3 eps{a.x, b.x, b.y, a.y, b.z, a.z};
    Vec3 x[4];
    for (int k = 0; k < 4; ++k) x[k] = c.rest[k] + eps * c.rest[k];
    const Real size2 = dot(a, a) + 2 * dot(b, b), trace = a.x + a.y + a.z;
    const Real expected = mu * size2 + lame / 2 * trace * trace;
    EXPECT_NEAR(c.element.energy(testConstants(), x) - atRest, expected, 2e-3 * expected);
  }
}

TEST(Spring, MultiplierConvergesToHookesLawAtAnyStiffness) {
  for (const Real stiffness : {1., 100., 1e4}) {
    Random random(8);
    Case<Spring> c = makeCase<Spring>(random, 0);
    c.element.stiffness = stiffness, c.element.lambda = 0;
    for (int step = 0; step < 400; ++step) {
      c.element.begin(testConstants(), c.rest);
      for (int i = 0; i < 20; ++i) c.element.updateDual(testConstants(), c.rest);
    }
    // what a step forgets of the multiplier it gets back from 1.2 g dt^2 / 20 of error
    // (docs/research/method.md, section 7)
    EXPECT_NEAR(c.element.lambda, stiffness * c.element.elongation(c.rest), 3e-4 * stiffness);
  }
}

/// The faces of a tetrahedron, counter-clockwise from outside, and its corners.
struct ClosedSurface {
  Vec3 x[4];
  static constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
};
template <class Of> void forEachFace(const ClosedSurface& s, Of&& of) {
  Pressure p{};
  p.pressure = 700;
  for (const auto& face : ClosedSurface::kFaces) {
    const Vec3 x[3] = {s.x[face[0]], s.x[face[1]], s.x[face[2]]};
    of(p, face, x);
  }
}
Vec3 forceOn(const ClosedSurface& s, int corner) {
  Vec3 sum{};
  forEachFace(s, [&](const Pressure& p, const int(&face)[3], const Vec3(&x)[3]) {
    for (int k = 0; k < 3; ++k)
      if (face[k] == corner) {
        Block3 block;
        p.accumulate(testConstants(), x, k, block);
        sum += block.f;
      }
  });
  return sum;
}

TEST(Pressure, ForcesOnAClosedSurfaceAreThoseOfItsVolumeAndAddUpToNothing) {
  Random random(9);
  for (int n = 0; n < 20; ++n) {
    ClosedSurface s;
    for (Vec3& x : s.x) x = random.vector(1) + Vec3{3, -2, 5};
    const auto energy = [&] {
      Real sum = 0;
      forEachFace(s, [&](const Pressure& p, const int(&)[3], const Vec3(&x)[3]) {
        sum += p.energy(testConstants(), x);
      });
      return sum;
    };
    const Real volume = dot(s.x[1] - s.x[0], cross(s.x[2] - s.x[0], s.x[3] - s.x[0])) / 6;
    EXPECT_NEAR(energy(), -700 * volume, 1e-9 * 700);
    Vec3 force{}, moment{};
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 own = forceOn(s, corner);
      force += own, moment += cross(s.x[corner], own);
      for (int axis = 0; axis < 3; ++axis) {
        constexpr Real h = 1e-4;
        const auto at = [&](Real step) {
          const Vec3 kept = s.x[corner];
          s.x[corner][axis] += step;
          const Real e = energy();
          const Vec3 f = forceOn(s, corner);
          s.x[corner] = kept;
          return std::pair{e, f};
        };
        const auto [up, forceUp] = at(h);
        const auto [down, forceDown] = at(-h);
        EXPECT_NEAR(own[axis], -(up - down) / (2 * h), 1e-5) << corner << " " << axis;
        EXPECT_LT(length(forceUp - forceDown), 1e-9) << "the Hessian of a vertex is zero";
      }
    }
    EXPECT_LT(length(force), 1e-9);
    EXPECT_LT(length(moment), 1e-9);
  }
}

TEST(FoldBend, MeasuresTheAngleBetweenItsTriangles) {
  for (const Real angle : {-2., -.3, 0., .5, 3.}) {
    const Vec3 x[4] = {{0, 0, 0}, {1, 0, 0}, {.5, 1, 0}, {.5, -std::cos(angle), std::sin(angle)}};
    FoldBend b{};
    EXPECT_NEAR(std::fabs(b.fold(x).angle), std::fabs(angle), 1e-12);
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
