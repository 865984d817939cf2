#pragma once
/// Probes and building blocks for scenes of deformable objects.
#include <functional>
#include <utility>
#include <vector>

#include "registry.h"

namespace rubble::scenes {

/// A number of a world, by the name of its metric.
struct Measure {
  std::string name;
  std::function<double(const World&)> of;
};
/// Taken at the end of the run.
std::unique_ptr<Probe> endProbe(std::vector<Measure> measures);
/// The largest value over the steps from `from` seconds on.
std::unique_ptr<Probe> peakProbe(double from, std::vector<Measure> measures);
/// The mean over the steps from `from` seconds on.
std::unique_ptr<Probe> meanProbe(double from, std::vector<Measure> measures);

/// Ratio of the longest edge of triangles and segments of an object to its length at rest.
double largestStretch(const World& world, int object);
/// Lowest height of all vertices of all objects along the opposite of gravity [m].
double lowestVertex(const World& world);
/// Tetrahedra of an object whose volume is no more than this share of that at rest.
double cellsBelow(const World& world, int object, double share);
/// Those with no more than half of it.
double crushedCells(const World& world, int object);
/// Volume inside of the surface of an object, which is closed [m3].
double volumeInside(const World& world, int object);
/// Mean position of some vertices.
Vec3 meanOf(const World& world, int object, const std::vector<int>& vertices);
/// Sum of the contact forces of vertices on bodies along the opposite of gravity [N].
double liftOfVertices(const World& world);
/// Dynamic bodies whose origin does not lie above the sheet that an object is; z is up.
double bodiesBelow(const World& world, int object);
/// Kinetic energy of all [J].
double motion(const World& world);

/// A square of heavy cloth at a height, held along its edges: "sheet", 4 mm, 2 MPa, 400 kg/m3.
ClothDef heldSheet(double side, double height, int cells);
/// Indices of the vertices with inside(position).
std::vector<int> verticesWhere(const DeformableDef& object, const std::function<bool(const Vec3&)>& inside);

}  // namespace rubble::scenes
