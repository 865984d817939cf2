/// <flexcomp>: cables, cloth and solids. Vertices have equal masses in MuJoCo; here they have those of their
/// elements at the density that gives the same total.
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <variant>

#include "convert/mjcf_flex_mesh.h"
#include "convert/mjcf_reader.h"
#include "io/mesh_file.h"

namespace rubble::convert {
namespace {

/// Pins by indices and ranges of these, by places of the grid and by ranges of these; ends are included.
void addPins(const Tag& tag, const FlexMesh& mesh, std::set<int>& pins) {
  const auto each = static_cast<std::size_t>(mesh.dimension);
  const auto whole = [&](const char* key, double value, int count) {
    if (!(value >= 0 && value < count) || value != std::floor(value))
      tag.fail(key, "whole numbers below " + std::to_string(count), std::to_string(value));
    return static_cast<int>(value);
  };
  const auto lists = [&](const char* key, std::size_t size) {
    auto list = tag.numbers(key, 0, kMostFlexPoints).value_or(std::vector<double>{});
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
  for (const double k : lists("id", 1)) pins.insert(whole("id", k, points));
  const std::vector<double> ranges = lists("range", 2), places = lists("grid", each),
                            boxes = lists("gridrange", 2 * each);
  for (std::size_t i = 0; i < ranges.size(); i += 2)
    for (int k = whole("range", ranges[i], points), last = whole("range", ranges[i + 1], points); k <= last;
         ++k)
      pins.insert(k);
  for (std::size_t i = 0; i < places.size(); i += each) addBox("grid", &places[i], &places[i]);
  for (std::size_t i = 0; i < boxes.size(); i += 2 * each) addBox("gridrange", &boxes[i], &boxes[i + each]);
}

/// Elasticity of a flexible object.
struct Elastic {
  double young = 0, poisson = 0;  ///< [Pa], [1]
  double bending = 0;             ///< Young's modulus that a sheet resists bending with [Pa]
  double damping = 0;             ///< of the rates of strain, over that of the strains [s]
  double thickness = -1;          ///< of a sheet; not above 0: twice its radius [m]
  double edge = 0;                ///< stiffness of edges [N/m], or kHard
};

Elastic elasticOf(const Tag& tag, Source& source, int dimension) {
  Elastic out;
  for (const pugi::xml_node& child : source.children(tag.node())) {
    const Tag part(source, child);
    if (part.type() == "elasticity") {
      source.use(child);
      out.young = part.number("young", 0), out.poisson = part.number("poisson", 0);
      out.damping = part.number("damping", 0), out.thickness = part.number("thickness", -1);
      if (out.young < 0 || out.poisson < 0 || out.poisson >= 0.5 || out.damping < 0)
        part.fail("young", "numbers of at least 0, and poisson below 0.5", "others");
      const std::size_t kind = part.choice("elastic2d", {"none", "bend", "stretch", "both"}, 0);
      out.bending = kind % 2 == 1 ? out.young : 0;
      if (dimension == 2 && kind < 2) out.young = 0;
    } else if (part.type() == "edge") {
      source.use(child);
      out.edge = part.number("stiffness", 0);
      if (part.text("equality").value_or("false") != "false") out.edge = kHard;
    }
  }
  return out;
}

template <class Def, class Put> double fill(Def& out, const FlexMesh& mesh, const Put& put) {
  const auto each = static_cast<std::size_t>(mesh.dimension) + 1;
  double size = 0;
  for (std::size_t k = 0; k < mesh.corners.size(); k += each) size += std::fabs(mesh.sizeOf(k)), put(out, k);
  return size;
}

/// The object; why it is none.
std::variant<Deformable, std::string> objectOf(const FlexMesh& mesh, const Elastic& elastic, double mass,
                                               double radius) {
  const auto corner = [&](std::size_t k) { return mesh.corners[k]; };
  const double viscosity = elastic.damping * elastic.young;
  if (mesh.dimension == 1) {
    CableDef out;
    const int count = static_cast<int>(mesh.points.size());
    for (std::size_t k = 0; k < mesh.corners.size(); k += 2) {
      const bool isLast = k + 2 == mesh.corners.size();
      out.closed = isLast && corner(k) == count - 1 && corner(k + 1) == 0;
      if (corner(k) != static_cast<int>(k / 2) || (corner(k + 1) != corner(k) + 1 && !out.closed))
        return "a cable that is no line of points in order";
    }
    out.radius = radius, out.youngsModulus = elastic.young, out.viscosity = viscosity;
    const double length = fill(out, mesh, [](CableDef&, std::size_t) {});
    out.density = mass / (length * std::numbers::pi * radius * radius);
    return out;
  }
  if (mesh.dimension == 2) {
    ClothDef out;
    out.thickness = elastic.thickness > 0 ? elastic.thickness : 2 * radius;
    out.youngsModulus = elastic.young, out.poissonRatio = elastic.poisson, out.viscosity = viscosity;
    out.bendingStiffness = elastic.bending * std::pow(out.thickness, 3) /
                           (12 * (1 - elastic.poisson * elastic.poisson));
    const double area = fill(out, mesh, [&](ClothDef& to, std::size_t k) {
      to.triangles.push_back({corner(k), corner(k + 1), corner(k + 2)});
    });
    out.density = mass / (area * out.thickness);
    return out;
  }
  TetSolidDef out;
  out.contactRadius = radius;
  out.youngsModulus = elastic.young, out.poissonRatio = elastic.poisson, out.viscosity = viscosity;
  const double volume = fill(out, mesh, [&](TetSolidDef& to, std::size_t k) {
    to.tetrahedra.push_back({corner(k), corner(k + 1), corner(k + 2), corner(k + 3)});
    if (mesh.sizeOf(k) < 0) std::swap(to.tetrahedra.back()[1], to.tetrahedra.back()[2]);
  });
  out.density = mass / volume;
  return out;
}

}  // namespace

std::optional<FlexMesh> MjcfReader::flexMeshOf(const Tag& tag) {
  const std::optional<int> given = tag.whole("dim", 1, 3);
  const int dimension = given.value_or(2);
  const bool isAsset = tag.has("mesh");
  const std::string type = tag.text("type").value_or(isAsset ? "mesh" : "grid");
  if (auto out = generatedFlex(tag, type, given)) return out;
  FlexMesh out;
  out.dimension = dimension;
  if (type == "direct") {
    out = writtenFlex(tag, dimension);
  } else if (type == "gmsh" || (type == "mesh" && dimension > 1)) {
    io::MeshFile file;
    if (isAsset) {
      const auto found = meshes_.find(tag.need("mesh"));
      if (found == meshes_.end()) tag.fail("mesh", "the name of a mesh", inQuotes(tag.need("mesh")));
      file.vertices = found->second.mesh.vertices, file.triangles = found->second.mesh.triangles;
    } else {
      file = io::readMesh(assetFile(tag, compiler_.meshFolder).string());
    }
    if (type == "gmsh") out.dimension = file.tetrahedra.empty() ? 2 : 3;
    out.points = file.vertices;
    const int first = type == "mesh" && dimension == 3;
    if (first == 1) out.points.insert(out.points.begin(), tag.vector("origin").value_or(Vec3{}));
    for (const auto& t : file.triangles) {
      if (out.dimension == 2) out.corners.insert(out.corners.end(), t.begin(), t.end());
      // a tetrahedron between the origin and each triangle that is seen from outside
      if (first == 1) out.corners.insert(out.corners.end(), {0, t[0] + 1, t[1] + 1, t[2] + 1});
      if (first == 1 && !(out.sizeOf(out.corners.size() - 4) > 0)) out.corners.resize(out.corners.size() - 4);
    }
    if (type == "gmsh")
      for (const auto& t : file.tetrahedra) out.corners.insert(out.corners.end(), t.begin(), t.end());
  } else {
    return std::nullopt;
  }
  if (const Vec3 scale = tag.vector("scale").value_or(Vec3{1, 1, 1}); !isAsset)
    for (Vec3& p : out.points) p = mul(p, scale);
  return out;
}

void MjcfReader::readFlexcomp(const Tag& tag, const MjcfScope& scope) {
  source_.use(tag.node());
  const std::string what = "flexcomp" + inQuotes(tag.name());
  const auto lose = [&](const std::string& why) {
    for (const pugi::xml_node& child : source_.children(tag.node())) source_.use(child);
    report_.note(Effect::Lost, tag.place(), what, why);
  };
  const auto approximate = [&](const char* key, const std::string& why) {
    report_.note(Effect::Approximate, tag.place(), std::string("flexcomp.") + key, why);
  };
  std::optional<FlexMesh> mesh = flexMeshOf(tag);
  if (!mesh) return lose("objects of its type and dimension");
  const auto each = static_cast<std::size_t>(mesh->dimension) + 1;
  if (mesh->corners.empty() || mesh->corners.size() % each != 0)
    tag.fail("element", "whole elements", "others");
  if (tag.flag("rigid", false)) return lose("a rigid object");
  const Pose inWorld = referencePose(scope.link) * scope.pose * poseOf(tag);
  for (Vec3& p : mesh->points) p = inWorld * p;

  const double mass = tag.number("mass", 1), radius = tag.number("radius", 0.005);
  if (!(mass > 0)) tag.fail("mass", "a mass above 0 [kg]", std::to_string(mass));
  if (!(radius > 0)) tag.fail("radius", "a radius above 0 [m]", std::to_string(radius));
  std::set<int> pins;
  constexpr std::size_t kRadial = 1;
  const std::size_t freedom = tag.choice("dof", {"full", "radial", "2d", "trilinear", "quadratic"}, 0);
  if (freedom > 0) approximate("dof", "each vertex moves in all directions");
  if (freedom == kRadial) pins.insert(0);
  Material material = materialOf(tag);
  bool collides = true, meetsItself = true;
  for (const pugi::xml_node& child : source_.children(tag.node())) {
    const Tag part(source_, child);
    if (part.type() == "pin") source_.use(child), addPins(part, *mesh, pins);
    if (part.type() != "contact") continue;
    source_.use(child);
    material = materialOf(part);
    constexpr int kLow = std::numeric_limits<int>::min(), kHigh = std::numeric_limits<int>::max();
    collides = part.whole("contype", kLow, kHigh).value_or(1) != 0 ||
               part.whole("conaffinity", kLow, kHigh).value_or(1) != 0;
    meetsItself = part.text("selfcollide").value_or("auto") != "none";
  }
  material.torsionalFriction = material.rollingFriction = 0;  // of bodies

  Elastic elastic = elasticOf(tag, source_, mesh->dimension);
  // springs of edges that are hard, or as stiff as an elastic material of this size
  constexpr double kStiff = 1e7, kSoft = 1e4;
  if (elastic.young == 0) {
    elastic.young = elastic.edge == kHard ? kStiff : kSoft;
    approximate("edge",
                "edges resist stretch with a Young's modulus of " + std::to_string(elastic.young) + " Pa");
  }
  if (mesh->dimension == 1) approximate("dim", "a cable resists stretch and bending, but not twist");
  approximate("mass", "vertices have the mass of their elements, not equal ones");
  auto made = objectOf(*mesh, elastic, mass, radius);
  if (const std::string* const why = std::get_if<std::string>(&made)) return lose(*why);
  SoftObject out;
  out.place = tag.place(), out.link = scope.link;
  for (const int pin : pins) out.pins.emplace_back(pin, scope.link == 0 ? -1 : scope.link);
  out.object = std::get<Deformable>(std::move(made));
  DeformableDef& object = common(out.object);
  object.name = tag.name() + scope.suffix;
  object.vertices = std::move(mesh->points);
  object.material = material, object.collide = object.collideSurface = collides;
  object.collideSelf = object.collideSelf && collides && meetsItself;
  try {
    validate(out.object, tag.place().text() + ": flexcomp");
  } catch (const Error& error) {
    return lose(error.what());
  }
  model_.objects.push_back(std::move(out));
}

}  // namespace rubble::convert
