#include "tests/fuzz/definitions.h"

namespace rubble::fuzz {
namespace {

void setCommon(ByteSource& in, DeformableDef& out) {
  const int vertices = static_cast<int>(out.vertices.size());
  for (int more = in.below(3); more > 0; --more) out.fixed.push_back(in.below(vertices));
  if (in.flag()) out.velocity = in.vector(-10, 10), out.angularVelocity = in.vector(-5, 5);
  if (in.seldom()) {
    out.start = out.vertices;
    for (Vec3& x : out.start) x += in.vector(-.2, .2);
  }
  out.material = material(in);
  if (in.seldom()) out.gravityScale = in.between(-2, 2);
  if (in.flag())
    out.collide = in.flag(), out.collideSurface = in.flag(), out.collideSelf = in.flag(),
    out.collideVertices = in.flag();
}

TetSolidDef tetSolid(ByteSource& in) {
  const Vec3 at = in.vector(-1, 1), size = in.vector(.05, 1);
  const std::array<int, 3> cells{1 + in.below(2), 1 + in.below(2), 1 + in.below(2)};
  TetSolidDef out = in.seldom() ? tetBall(at, size.x, 2) : tetBox(at, size, cells);
  out.youngsModulus = in.ratio(1e2, 1e9), out.poissonRatio = in.between(0, .49);
  out.density = in.ratio(10, 1e4);
  if (in.flag()) out.viscosity = in.between(0, 1e3);
  if (in.flag()) out.yieldStress = in.ratio(10, 1e6), out.hardening = in.between(0, 1e4);
  if (in.flag()) out.contactRadius = in.between(0, .05);
  setCommon(in, out);
  return out;
}

ClothDef cloth(ByteSource& in) {
  const Vec3 corner = in.vector(-1, 1), u = in.vector(-1, 1), v = in.vector(-1, 1);
  const int cellsU = 1 + in.below(4), cellsV = 1 + in.below(4);
  ClothDef out = clothSheet(corner, u, v, cellsU, cellsV);
  out.thickness = in.ratio(1e-4, .05), out.youngsModulus = in.ratio(1e3, 1e9);
  out.poissonRatio = in.between(-.5, .5), out.density = in.ratio(10, 1e4);
  if (in.flag()) out.viscosity = in.between(0, 1e3);
  if (in.flag()) out.bendingStiffness = in.between(0, .1);
  if (in.flag()) out.restFolded = true, out.bendingDamping = in.between(0, .1);
  if (in.seldom()) out.tearStretch = in.between(1.01, 2);
  if (in.seldom()) out.pressure = in.between(-100, 100);
  setCommon(in, out);
  return out;
}

CableDef cable(ByteSource& in) {
  const Vec3 from = in.vector(-1, 1), to = in.vector(-1, 1);
  CableDef out = straightCable(from, to, 1 + in.below(12));
  if (in.flag())
    for (Vec3& x : out.vertices) x += in.vector(-.3, .3);
  out.closed = in.seldom();
  out.radius = in.ratio(1e-3, .2), out.youngsModulus = in.ratio(1e3, 1e10);
  out.density = in.ratio(10, 1e4);
  if (in.flag()) out.viscosity = in.between(0, 1e3);
  if (in.seldom()) out.breakForce = in.ratio(.1, 1e4);
  setCommon(in, out);
  return out;
}

NetDef net(ByteSource& in) {
  NetDef out;
  const int side = 2 + in.below(3);
  for (int i = 0; i < side * side; ++i)
    out.vertices.push_back(.3 * Vec3{double(i % side), double(i / side), 2} + in.vector(-.1, .1));
  for (int i = 0; i < side * side; ++i) {
    if (i % side > 0) out.edges.push_back({i - 1, i, in.ratio(1, 1e7), in.between(0, 10)});
    if (i >= side) out.edges.push_back({i - side, i, in.ratio(1, 1e7), 0, in.between(-.1, .5)});
  }
  out.masses = {in.ratio(1e-3, 10)};
  for (int more = in.below(4); more > 0; --more)
    out.triangles.push_back({in.below(side * side), in.below(side * side), in.below(side * side)});
  out.contactRadius = in.between(0, .1);
  if (in.seldom()) out.breakForce = in.ratio(.1, 1e4);
  setCommon(in, out);
  return out;
}

ParticlesDef particles(ByteSource& in) {
  ParticlesDef out;
  for (int more = 1 + in.below(16); more > 0; --more) out.vertices.push_back(in.vector(-.5, .5));
  out.radius = in.ratio(.005, .2), out.density = in.ratio(10, 1e4);
  setCommon(in, out);
  return out;
}

std::vector<double> weights(ByteSource& in, std::size_t count) {
  std::vector<double> out(count);
  double sum = 0;
  for (double& w : out) sum += w = in.between(.1, 1);
  for (double& w : out) w /= sum;
  return out;
}

}  // namespace

Deformable deformable(ByteSource& in) {
  switch (in.below(5)) {
    case 0:
      return tetSolid(in);
    case 1:
      return cloth(in);
    case 2:
      return cable(in);
    case 3:
      return net(in);
    default:
      return particles(in);
  }
}

AttachmentDef attachment(ByteSource& in, int vertices, int otherVertices) {
  AttachmentDef out;
  for (int more = 1 + in.below(otherVertices > 0 ? 2 : 4); more > 0; --more)
    out.vertices.push_back(in.below(vertices));
  if (in.flag()) out.weights = weights(in, out.vertices.size());
  if (otherVertices > 0)
    for (int more = 1 + in.below(2); more > 0; --more) out.otherVertices.push_back(in.below(otherVertices));
  if (in.flag()) out.anchor = in.vector(-1, 1);
  if (in.flag()) out.stiffness = in.ratio(1, 1e7);
  if (in.seldom()) out.breakForce = in.ratio(.1, 1e4);
  return out;
}

}  // namespace rubble::fuzz
