#include "convert/mjcf_flex_mesh.h"

#include <cmath>
#include <numbers>

namespace rubble::convert {
namespace {

/// Places of a grid about its center.
struct Lattice {
  std::array<int, 3> counts{1, 1, 1};
  Vec3 spacing;  ///< [m]

  int index(int x, int y, int z) const { return (x * counts[1] + y) * counts[2] + z; }
  double middle(std::size_t axis) const { return (counts[axis] - 1) / 2.; }
  Vec3 at(int x, int y, int z) const { return mul(spacing, {x - middle(0), y - middle(1), z - middle(2)}); }
};

Lattice latticeOf(const Tag& tag, int dimension) {
  const auto counts = tag.numbers("count", 3, 3).value_or(std::vector<double>{10, 10, 10});
  Lattice out;
  out.spacing = tag.vector("spacing").value_or(Vec3{0.02, 0.02, 0.02});
  double all = 1;
  for (int k = 0; k < dimension; ++k) {
    const double count = counts[static_cast<std::size_t>(k)];
    if (!(count >= 2 && count <= kMostFlexPoints) || count != std::floor(count))
      tag.fail("count", "2 or more in each dimension", std::to_string(count));
    if (!(out.spacing[k] > 0)) tag.fail("spacing", "numbers above 0 [m]", std::to_string(out.spacing[k]));
    out.counts[static_cast<std::size_t>(k)] = static_cast<int>(count), all *= count;
  }
  if (dimension == 2 && counts[2] != 1)
    tag.fail("count", "1 beyond the dimension", std::to_string(counts[2]));
  if (all > kMostFlexPoints) tag.fail("count", "at most 200000 points", std::to_string(all));
  return out;
}

void add(FlexMesh& mesh, std::initializer_list<int> corners) {
  mesh.corners.insert(mesh.corners.end(), corners);
}

FlexMesh lineOf(const Tag& tag) {
  const Lattice lattice = latticeOf(tag, 1);
  FlexMesh out;
  out.dimension = 1, out.counts = lattice.counts;
  for (int x = 0; x < lattice.counts[0]; ++x) {
    out.points.push_back(lattice.at(x, 0, 0));
    if (x > 0) add(out, {x - 1, x});
  }
  return out;
}

/// A ring, the first and last points of which are one.
FlexMesh ringOf(const Tag& tag) {
  const Lattice lattice = latticeOf(tag, 1);
  const int count = lattice.counts[0] - 1;
  if (count < 3) tag.fail("count", "4 or more points of a circle", std::to_string(count + 1));
  const double angle = 2 * std::numbers::pi / count, radius = lattice.spacing.x / (2 * std::sin(angle / 2));
  FlexMesh out;
  out.dimension = 1;
  for (int k = 0; k < count; ++k) {
    out.points.push_back({radius * std::cos(angle * k), radius * std::sin(angle * k), 0});
    add(out, {k, (k + 1) % count});
  }
  return out;
}

/// A sheet, or one whose squares about the center become circles. As in MuJoCo, the radius of a circle is
/// half the side of the sheet times half the side of its square [m2].
FlexMesh sheetOf(const Tag& tag, bool isDisc) {
  const Lattice lattice = latticeOf(tag, 2);
  FlexMesh out;
  out.counts = lattice.counts;
  const double half[2] = {lattice.spacing.x * lattice.middle(0), lattice.spacing.y * lattice.middle(1)};
  constexpr double kNone = 1e-14;
  for (int x = 0; x < lattice.counts[0]; ++x)
    for (int y = 0; y < lattice.counts[1]; ++y) {
      const Vec3 p = lattice.at(x, y, 0);
      const double reach = std::max(std::fabs(p.x), std::fabs(p.y)), along = isDisc ? length(p) : 0;
      out.points.push_back(along > 0 ? reach / along * Vec3{half[0] * p.x, half[1] * p.y, 0} : p);
      if (x + 1 == lattice.counts[0] || y + 1 == lattice.counts[1]) continue;
      const int a = lattice.index(x, y, 0), b = lattice.index(x + 1, y, 0),
                c = lattice.index(x + 1, y + 1, 0), d = lattice.index(x, y + 1, 0);
      // diagonals of a disc point to its center
      const bool turned = (p.x < -kNone && p.y > -kNone) || (p.x > -kNone && p.y < -kNone);
      if (isDisc && turned)
        add(out, {a, b, d}), add(out, {b, c, d});
      else
        add(out, {a, b, c}), add(out, {a, c, d});
    }
  return out;
}

FlexMesh blockOf(const Tag& tag) {
  const Lattice lattice = latticeOf(tag, 3);
  FlexMesh out;
  out.dimension = 3, out.counts = lattice.counts;
  const auto& n = lattice.counts;
  for (int x = 0; x < n[0]; ++x)
    for (int y = 0; y < n[1]; ++y)
      for (int z = 0; z < n[2]; ++z) {
        out.points.push_back(lattice.at(x, y, z));
        if (x + 1 == n[0] || y + 1 == n[1] || z + 1 == n[2]) continue;
        // six around the diagonal of the cell
        const int order[6][2] = {{0, 1}, {1, 0}, {0, 2}, {2, 0}, {1, 2}, {2, 1}};
        for (const auto& o : order) {
          int corner[3] = {x, y, z};
          const auto here = [&] { return lattice.index(corner[0], corner[1], corner[2]); };
          const int a = here();
          const int b = (++corner[o[0]], here()), c = (++corner[o[1]], here());
          add(out, {a, b, c, lattice.index(x + 1, y + 1, z + 1)});
        }
      }
  return out;
}

/// The outer points of a grid, moved onto a shape: a solid of tetrahedra about the center, or a sheet without
/// its top.
FlexMesh shellOf(const Tag& tag, const std::string& type, bool isSolid) {
  const Lattice lattice = latticeOf(tag, 3);
  const auto& n = lattice.counts;
  const Vec3 half = mul(lattice.spacing, {lattice.middle(0), lattice.middle(1), lattice.middle(2)});
  const auto onShape = [&](int x, int y, int z) {
    Vec3 p{x / lattice.middle(0) - 1, y / lattice.middle(1) - 1, z / lattice.middle(2) - 1};
    if (type == "ellipsoid") p = normalize(p);
    const double across = std::hypot(p.x, p.y);
    if (type == "cylinder" && across > 0) {
      const double radius = std::max(std::fabs(p.x), std::fabs(p.y)) / across;
      p.x *= radius, p.y *= radius;
    }
    return mul(half, p);
  };
  FlexMesh out;
  out.dimension = isSolid ? 3 : 2;
  if (isSolid) out.points.push_back({});
  std::vector<int> indices(static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1] * n[2]), -1);
  const auto eachSide = [&](const auto& visit) {
    for (const std::size_t across : {2u, 1u, 0u})
      for (const int side : {0, n[across] - 1})
        if (isSolid || across != 2 || side == 0)
          visit(across, side, across == 0 ? 1u : 0u, across == 2 ? 1u : 2u);
  };
  eachSide([&](std::size_t across, int side, std::size_t u, std::size_t v) {
    std::array<int, 3> at{};
    at[across] = side;
    for (at[u] = 0; at[u] < n[u]; ++at[u])
      for (at[v] = 0; at[v] < n[v]; ++at[v]) {
        int& index = indices[static_cast<std::size_t>(lattice.index(at[0], at[1], at[2]))];
        if (index >= 0) continue;
        index = static_cast<int>(out.points.size());
        out.points.push_back(onShape(at[0], at[1], at[2]));
      }
  });
  eachSide([&](std::size_t across, int side, std::size_t u, std::size_t v) {
    std::array<int, 3> at{};
    at[across] = side;
    for (int i = 0; i + 1 < n[u]; ++i)
      for (int j = 0; j + 1 < n[v]; ++j) {
        // sides of a sheet are seen from outside
        const int mirrored = !isSolid && (across == 1 ? side > 0 : across == 0 && side == 0);
        const auto corner = [&](int alongU, int alongV) {
          at[u] = i + (alongU ^ mirrored), at[v] = j + alongV;
          return indices[static_cast<std::size_t>(lattice.index(at[0], at[1], at[2]))];
        };
        const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        if (isSolid)
          add(out, {0, a, b, c}), add(out, {0, a, d, c});
        else if (across == 2)
          add(out, {a, c, b}), add(out, {a, d, c});
        else
          add(out, {a, b, c}), add(out, {a, c, d});
      }
  });
  return out;
}

}  // namespace

double FlexMesh::sizeOf(std::size_t k) const {
  const Vec3 a = corner(k + 1) - corner(k);
  if (dimension == 1) return length(a);
  const Vec3 normal = cross(a, corner(k + 2) - corner(k));
  return dimension == 2 ? length(normal) / 2 : dot(normal, corner(k + 3) - corner(k)) / 6;
}

std::optional<FlexMesh> generatedFlex(const Tag& tag, const std::string& type, std::optional<int> dimension) {
  if (type == "square" || type == "disc") return sheetOf(tag, type == "disc");
  if (type == "box" || type == "cylinder" || type == "ellipsoid")
    return shellOf(tag, type, dimension.value_or(3) == 3);
  if (type != "grid" && type != "circle") return std::nullopt;
  if (dimension == 1) return type == "circle" ? ringOf(tag) : lineOf(tag);
  return dimension == 3 ? blockOf(tag) : sheetOf(tag, false);
}

FlexMesh writtenFlex(const Tag& tag, int dimension) {
  const auto points = tag.numbers("point", 3, 3 * kMostFlexPoints),
             elements = tag.numbers("element", 2, 40 * kMostFlexPoints);
  if (!points || !elements || points->size() % 3 != 0) tag.fail("point", "points and elements", "others");
  FlexMesh out;
  out.dimension = dimension;
  for (std::size_t i = 0; i < points->size(); i += 3)
    out.points.push_back({(*points)[i], (*points)[i + 1], (*points)[i + 2]});
  for (const double v : *elements) {
    if (!(v >= 0 && v < static_cast<double>(out.points.size())) || v != std::floor(v))
      tag.fail("element", "indices of points", std::to_string(v));
    out.corners.push_back(static_cast<int>(v));
  }
  return out;
}

}  // namespace rubble::convert
