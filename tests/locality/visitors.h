#pragma once
/// Objects added to a scene 700 m away, which must change nothing in it.
#include <functional>
#include <string>
#include <vector>

#include <rubble/rubble.h>

namespace rubble::test {

struct Visitor {
  std::string name;
  /// Adds it to a scene about a point. What must lie on something brings it along.
  std::function<void(Scene&, const Vec3&)> addTo;
};
/// One of each kind; heaps have so many pebbles.
std::vector<Visitor> visitors(int pebbles);

/// A point of a scene's surroundings: far from all that it has, and over every plane. Zero: planes leave no
/// such point.
Vec3 farFrom(const Scene& scene);

/// The scene with visitors whose bodies come before its own. Without room for them, the scene.
Scene withVisitorsFirst(const Scene& scene, const std::vector<Visitor>& visitors);

}  // namespace rubble::test
