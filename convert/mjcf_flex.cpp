/// <flexcomp>: cables, cloth and solids. Vertices have equal masses in MuJoCo; here they have those of their
/// elements at the density that gives the same total.
#include <algorithm>
#include <cmath>
#include <set>

#include "convert/mjcf_reader.h"
#include "io/mesh_file.h"

namespace rubble::convert {
namespace {

constexpr int kMostPoints = 200000;

struct FlexMesh {
  std::vector<Vec3> points;
  std::vector<int> corners;            ///< dimension + 1 for each element
  std::array<int, 3> counts{0, 1, 1};  ///< of a grid
};

/// Points of a grid, z fastest, and its elements.
FlexMesh gridOf(const Tag& tag, int dimension) {
  const auto counts = tag.numbers("count", 3, 3).value_or(std::vector<double>{10, 10, 10});
  const Vec3 spacing = tag.vector("spacing").value_or(Vec3{0.02, 0.02, 0.02});
  int n[3];
  double all = 1;
  for (int k = 0; k < 3; ++k) {
    const double each = counts[static_cast<std::size_t>(k)];
    if (!(each >= 1 && each <= kMostPoints) || each != std::floor(each))
      tag.fail("count", "whole numbers above 0", std::to_string(each));
    n[k] = static_cast<int>(each), all *= each;
    if (k >= dimension && n[k] != 1) tag.fail("count", "1 beyond the dimension", std::to_string(n[k]));
    if (k < dimension && n[k] < 2) tag.fail("count", "2 or more in each dimension", std::to_string(n[k]));
    if (!(spacing[k] > 0)) tag.fail("spacing", "numbers above 0 [m]", std::to_string(spacing[k]));
  }
  if (all > kMostPoints) tag.fail("count", "at most 200000 points", std::to_string(all));
  FlexMesh out;
  out.counts = {n[0], n[1], n[2]};
  const auto at = [&](int x, int y, int z) { return (x * n[1] + y) * n[2] + z; };
  for (int x = 0; x < n[0]; ++x)
    for (int y = 0; y < n[1]; ++y)
      for (int z = 0; z < n[2]; ++z)
        out.points.push_back(
            mul(spacing, Vec3{x - (n[0] - 1) / 2., y - (n[1] - 1) / 2., z - (n[2] - 1) / 2.}));
  const auto add = [&](std::initializer_list<int> corners) {
    out.corners.insert(out.corners.end(), corners);
  };
  for (int x = 0; x + 1 < n[0]; ++x) {
    if (dimension == 1) add({x, x + 1});
    for (int y = 0; dimension >= 2 && y + 1 < n[1]; ++y) {
      if (dimension == 2)
        add({at(x, y, 0), at(x + 1, y, 0), at(x + 1, y + 1, 0)}),
            add({at(x, y, 0), at(x + 1, y + 1, 0), at(x, y + 1, 0)});
      for (int z = 0; dimension == 3 && z + 1 < n[2]; ++z) {
        // six around the diagonal of the cell
        const int order[6][2] = {{0, 1}, {1, 0}, {0, 2}, {2, 0}, {1, 2}, {2, 1}};
        for (const auto& o : order) {
          int corner[3] = {x, y, z};
          const auto here = [&] { return at(corner[0], corner[1], corner[2]); };
          const int a = here();
          const int b = (++corner[o[0]], here()), c = (++corner[o[1]], here());
          add({a, b, c, at(x + 1, y + 1, z + 1)});
        }
      }
    }
  }
  return out;
}

double volumeOf(const FlexMesh& mesh, std::size_t at) {
  const auto p = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(mesh.corners[at + k])]; };
  return dot(cross(p(1) - p(0), p(2) - p(0)), p(3) - p(0)) / 6;
}

/// Pins by ranges of indices, by places of the grid and by ranges of these; ends are included.
void addPins(const Tag& tag, const FlexMesh& mesh, int dimension, std::set<int>& pins) {
  const auto each = static_cast<std::size_t>(dimension);
  const auto whole = [&](const char* key, double value, int count) {
    if (!(value >= 0 && value < count) || value != std::floor(value))
      tag.fail(key, "whole numbers below " + std::to_string(count), std::to_string(value));
    return static_cast<int>(value);
  };
  const auto lists = [&](const char* key, std::size_t size) {
    auto list = tag.numbers(key, 0, kMostPoints).value_or(std::vector<double>{});
    if (list.size() % size != 0)
      tag.fail(key, std::to_string(size) + " numbers for each", std::to_string(list.size()));
    if (!list.empty() && key[0] == 'g' && mesh.counts[0] == 0)
      tag.fail(key, "places in an object of the type grid", "another type");
    return list;
  };
  const auto addBox = [&](const char* key, const double* low, const double* high) {
    int from[3] = {}, to[3] = {};
    for (std::size_t k = 0; k < each; ++k)
      from[k] = whole(key, low[k], mesh.counts[k]), to[k] = whole(key, high[k], mesh.counts[k]);
    for (int x = from[0]; x <= to[0]; ++x)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int z = from[2]; z <= to[2]; ++z) pins.insert((x * mesh.counts[1] + y) * mesh.counts[2] + z);
  };
  const int points = static_cast<int>(mesh.points.size());
  const std::vector<double> ranges = lists("range", 2), places = lists("grid", each),
                            boxes = lists("gridrange", 2 * each);
  for (std::size_t i = 0; i < ranges.size(); i += 2)
    for (int k = whole("range", ranges[i], points), last = whole("range", ranges[i + 1], points); k <= last;
         ++k)
      pins.insert(k);
  for (std::size_t i = 0; i < places.size(); i += each) addBox("grid", &places[i], &places[i]);
  for (std::size_t i = 0; i < boxes.size(); i += 2 * each) addBox("gridrange", &boxes[i], &boxes[i + each]);
}

}  // namespace

void MjcfReader::readFlexcomp(const Tag& tag, const MjcfScope& scope) {
  source_.use(tag.node());
  const auto lose = [&](const std::string& why) {
    for (const pugi::xml_node& child : source_.children(tag.node())) source_.use(child);
    report_.note(Effect::Lost, tag.place(), "flexcomp" + inQuotes(tag.name()), why);
  };
  const int dimension = tag.whole("dim", 1, 3).value_or(2);
  const std::string type = tag.text("type").value_or("grid");
  FlexMesh mesh;
  if (type == "grid") {
    mesh = gridOf(tag, dimension);
  } else if (type == "direct") {
    const auto points = tag.numbers("point", 3, 3 * kMostPoints),
               elements = tag.numbers("element", 2, 40 * kMostPoints);
    if (!points || !elements || points->size() % 3 != 0) tag.fail("point", "points and elements", "others");
    for (std::size_t i = 0; i < points->size(); i += 3)
      mesh.points.push_back({(*points)[i], (*points)[i + 1], (*points)[i + 2]});
    for (const double v : *elements) {
      if (!(v >= 0 && v < static_cast<double>(mesh.points.size())) || v != std::floor(v))
        tag.fail("element", "indices of points", std::to_string(v));
      mesh.corners.push_back(static_cast<int>(v));
    }
  } else if ((type == "mesh" && dimension == 2) || (type == "gmsh" && dimension == 3)) {
    const io::MeshFile file = io::readMesh(assetFile(tag, compiler_.meshFolder).string());
    mesh.points = file.vertices;
    if (dimension == 2)
      for (const auto& t : file.surface().triangles)
        mesh.corners.insert(mesh.corners.end(), t.begin(), t.end());
    else
      for (const auto& t : file.tetrahedra) mesh.corners.insert(mesh.corners.end(), t.begin(), t.end());
  } else {
    return lose("objects of the type " + type + " in " + std::to_string(dimension) + " dimensions");
  }
  const auto each = static_cast<std::size_t>(dimension + 1);
  if (mesh.corners.empty() || mesh.corners.size() % each != 0)
    tag.fail("element", "whole elements", "others");
  if (tag.flag("rigid", false)) return lose("a rigid object");
  const Vec3 scale = tag.vector("scale").value_or(Vec3{1, 1, 1});
  Pose parent = referencePose(scope.link) * scope.pose;
  for (Vec3& p : mesh.points) p = parent * (poseOf(tag) * mul(p, scale));

  const double mass = tag.number("mass", 1), radius = tag.number("radius", 0.005);
  if (!(mass > 0)) tag.fail("mass", "a mass above 0 [kg]", std::to_string(mass));
  if (!(radius > 0)) tag.fail("radius", "a radius above 0 [m]", std::to_string(radius));
  double young = 0, poisson = 0, damping = 0, thickness = -1, edgeStiffness = 0;
  std::set<int> pins;
  for (const pugi::xml_node& child : source_.children(tag.node())) {
    const Tag part(source_, child);
    if (part.type() == "elasticity") {
      source_.use(child);
      young = part.number("young", 0), poisson = part.number("poisson", 0);
      damping = part.number("damping", 0), thickness = part.number("thickness", -1);
      if (young < 0 || poisson < 0 || poisson >= 0.5 || damping < 0)
        part.fail("young", "numbers of at least 0, and poisson below 0.5", "others");
    } else if (part.type() == "edge") {
      source_.use(child);
      edgeStiffness = part.number("stiffness", 0);
      if (part.flag("equality", false)) edgeStiffness = kHard;
    } else if (part.type() == "pin") {
      source_.use(child);
      for (const double v : part.numbers("id", 0, kMostPoints).value_or(std::vector<double>{})) {
        if (!(v >= 0 && v < static_cast<double>(mesh.points.size())))
          part.fail("id", "indices of points", std::to_string(v));
        pins.insert(static_cast<int>(v));
      }
      addPins(part, mesh, dimension, pins);
    } else if (part.type() == "contact") {
      source_.use(child);
      report_.note(Effect::Approximate, part.place(), "flexcomp.contact", "contacts have the usual friction");
    }
  }
  // springs of edges that are hard, or as stiff as an elastic material of this size
  constexpr double kStiff = 1e7, kSoft = 1e4;
  if (young == 0) {
    young = edgeStiffness == kHard ? kStiff : kSoft;
    report_.note(Effect::Approximate, tag.place(), "flexcomp.edge",
                 "an object without elasticity has a Young's modulus of " + std::to_string(young) + " Pa");
  }
  SoftObject out;
  out.place = tag.place(), out.link = scope.link;
  for (const int pin : pins) out.pins.emplace_back(pin, scope.link == 0 ? -1 : scope.link);
  double size = 0;
  if (dimension == 1) {
    CableDef cable;
    cable.radius = radius, cable.youngsModulus = young, cable.viscosity = damping * young;
    for (std::size_t i = 0; i < mesh.corners.size(); i += 2) {
      if (mesh.corners[i + 1] != mesh.corners[i] + 1)
        return lose("a cable that is no line of points in order");
      size += length(mesh.points[static_cast<std::size_t>(mesh.corners[i])] -
                     mesh.points[static_cast<std::size_t>(mesh.corners[i + 1])]);
    }
    cable.density = mass / (size * std::acos(-1.) * radius * radius);
    out.object = cable;
  } else if (dimension == 2) {
    ClothDef cloth;
    cloth.thickness = thickness > 0 ? thickness : 2 * radius;
    cloth.youngsModulus = young, cloth.poissonRatio = poisson, cloth.viscosity = damping * young;
    for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
      cloth.triangles.push_back({mesh.corners[i], mesh.corners[i + 1], mesh.corners[i + 2]});
      const auto p = [&](std::size_t k) {
        return mesh.points[static_cast<std::size_t>(mesh.corners[i + k])];
      };
      size += length(cross(p(1) - p(0), p(2) - p(0))) / 2;
    }
    cloth.density = mass / (size * cloth.thickness);
    out.object = cloth;
  } else {
    TetSolidDef solid;
    solid.contactRadius = radius;
    solid.youngsModulus = young, solid.poissonRatio = poisson, solid.viscosity = damping * young;
    for (std::size_t i = 0; i < mesh.corners.size(); i += 4) {
      std::array<int, 4> t{mesh.corners[i], mesh.corners[i + 1], mesh.corners[i + 2], mesh.corners[i + 3]};
      const double volume = volumeOf(mesh, i);
      if (volume < 0) std::swap(t[1], t[2]);
      size += std::fabs(volume);
      solid.tetrahedra.push_back(t);
    }
    solid.density = mass / size;
    out.object = solid;
  }
  DeformableDef& object = common(out.object);
  object.name = tag.name() + scope.suffix;
  object.vertices = std::move(mesh.points);
  try {
    validate(out.object, tag.place().text() + ": flexcomp");
  } catch (const Error& error) {
    return lose(error.what());
  }
  model_.objects.push_back(std::move(out));
}

}  // namespace rubble::convert
