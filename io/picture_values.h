#pragma once
/// Quantities that colors can show: one number for each body and vertex.
#include <string>
#include <vector>

#include "io/picture.h"

namespace rubble::io {

struct Quantity {
  ColorBy by;
  const char* key;   ///< on the command line
  const char* unit;  ///< "1" for none
  const char* doc;
  bool isKind;  ///< values are categories without an order; negative: none
};
/// All of them, in the order of ColorBy.
const std::vector<Quantity>& quantities();
const Quantity& quantity(ColorBy by);
/// Throws Error for an unknown key.
ColorBy colorByNamed(const std::string& key);
/// Can bodies without a world, of a recording, be colored by it?
bool knownWithoutWorld(ColorBy by);

/// Of all bodies, in the order of World::bodies(); empty where bodies have none of their own (Body, Speed).
///   Material    number of the material among those of the world
///   Island      lowest slot among the bodies connected by touching contacts and joints; -1:
///               touches nothing
///   Color       of the last step's coloring; -1: none
///   Error       largest penetration, gap of a joint or of an attachment [m]
///   Multiplier, Stiffness   largest ones of the rows that act on it [N], [N/m]
///   Strain      not a number: bodies are rigid
std::vector<double> bodyValues(const World& world, ColorBy by);
/// The same of the vertices of each deformable object, in the order of World::deformables(). Strain: largest
/// |l / l_0 - 1| of the edges at a vertex, l_0 their lengths at rest.
std::vector<std::vector<float>> vertexValues(const World& world, ColorBy by);

/// The value that a body is colored by.
double shownValue(const PictureBody& body, ColorBy by);
/// The largest one in a picture, of bodies that are not static.
double largestValue(std::span<const PictureBody> bodies, ColorBy by);

}  // namespace rubble::io
