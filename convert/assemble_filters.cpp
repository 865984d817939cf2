/// Collision filters. Bodies with the same masks of geoms form a class, each class is one layer, and the mask
/// of a class holds the classes that it collides with by the rule of the model. This is exact for up to 32
/// classes.
#include <algorithm>
#include <map>
#include <set>

#include "convert/assemble.h"

namespace rubble::convert {
namespace {

constexpr std::size_t kLayers = 32;

using Class = std::set<Contact>;

bool masksCollide(const Contact& i, const Contact& j) {
  return (i.type & j.affinity) != 0 || (j.type & i.affinity) != 0;
}

bool collide(const Class& a, const Class& b) {
  for (const Contact& i : a)
    for (const Contact& j : b)
      if (masksCollide(i, j) || (i.pairs & j.pairs) != 0) return true;
  return false;
}

Class classOf(const std::vector<Contact>& contacts, bool withPairs) {
  Class out;
  for (Contact each : contacts) {
    if (!withPairs) each.pairs = 0;
    out.insert(each);
  }
  return out;
}

/// Returns whether pairs of geoms are in the filters.
bool addLayers(const Layout& layout, Scene& scene, Report& report) {
  std::map<Class, std::uint32_t> layerOf;
  bool mixed = false, withPairs = true;
  const Place place{report.file, 1};
  const auto count = [&] {
    layerOf.clear();
    for (const std::vector<Contact>& contacts : layout.contactsOf) {
      const Class own = classOf(contacts, withPairs);
      mixed = mixed || classOf(contacts, false).size() > 1;
      if (!own.empty()) layerOf.try_emplace(own, static_cast<std::uint32_t>(layerOf.size()));
    }
  };
  count();
  if (layerOf.size() > kLayers) {
    withPairs = false, count();
    if (layerOf.size() <= kLayers)
      report.note(Effect::Lost, place, "pair", "pairs, which make more than 32 combinations of masks");
  }
  if (mixed)
    report.note(Effect::Approximate, place, "contype, conaffinity",
                "a body collides with all of its geoms if it does with one of them");
  if (layerOf.size() > kLayers) {
    report.note(Effect::Lost, place, "contype, conaffinity",
                "more than 32 combinations: all bodies collide with one another");
    return withPairs;
  }
  if (layerOf.empty()) return withPairs;
  const Class& first = layerOf.begin()->first;
  if (layerOf.size() == 1 && collide(first, first)) return withPairs;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Class own = classOf(layout.contactsOf[i], withPairs);
    if (own.empty()) continue;
    CollisionFilter& filter = scene.bodies[i].filter;
    filter.layers = 1u << layerOf.at(own), filter.mask = 0;
    for (const auto& [other, layer] : layerOf)
      if (collide(own, other)) filter.mask |= 1u << layer;
  }
  return withPairs;
}

std::vector<int> bodiesOf(const Layout& layout, int link) {
  if (link < 0) return {};
  const int body = bodyIndex(layout, link);
  return body == kWorld ? layout.staticOf[static_cast<std::size_t>(link)] : std::vector<int>{body};
}

/// Pairs of geoms, which collide though a joint or an exclusion keeps their bodies apart.
class Pairs {
 public:
  Pairs(const Layout& layout, bool kept) : layout_(layout), kept_(kept) {}

  /// Do bodies that are kept apart collide? They do not if more of their geoms would, and the pair is lost.
  bool join(int bodyA, int bodyB) {
    if (!kept_ || bodyA == kWorld || bodyB == kWorld) return false;
    std::uint64_t shared = 0;
    bool others = false;
    for (const Contact& a : layout_.contactsOf[static_cast<std::size_t>(bodyA)])
      for (const Contact& b : layout_.contactsOf[static_cast<std::size_t>(bodyB)]) {
        shared |= a.pairs & b.pairs;
        others = others || ((a.pairs & b.pairs) == 0 && masksCollide(a, b));
      }
    if (others) lost_ |= shared;
    return shared != 0 && !others;
  }

  void tell(const Model& model, Report& report) const {
    for (std::size_t i = 0; kept_ && i < model.pairs.size(); ++i) {
      const GeomPair& each = model.pairs[i];
      const std::string what = "pair" + inQuotes(each.name);
      if (rootOf(layout_, each.geomA.first) == rootOf(layout_, each.geomB.first))
        report.note(Effect::None, each.place, what, "its bodies do not move relative to one another");
      else if ((lost_ >> i & 1) != 0)
        report.note(Effect::Lost, each.place, what,
                    "its bodies are kept apart, for other geoms of them would collide too");
      else
        report.converted(each.place, what, "pair of bodies that collide");
    }
  }

 private:
  const Layout& layout_;
  bool kept_;
  std::uint64_t lost_ = 0;  ///< a bit for each of Model::pairs
};

}  // namespace

void addFilters(const Model& model, const Layout& layout, Scene& scene, Report& report) {
  Pairs named(layout, addLayers(layout, scene, report));
  for (JointDef& joint : scene.joints)
    if (!joint.collide && named.join(joint.bodyA, joint.bodyB)) joint.collide = true;
  std::set<std::pair<int, int>> pairs;
  const auto exclude = [&](int linkA, int linkB) {
    for (const int a : bodiesOf(layout, linkA))
      for (const int b : bodiesOf(layout, linkB))
        if (a != b && !named.join(a, b)) pairs.insert(std::minmax(a, b));
  };
  for (const auto& [a, b] : model.exclusions) exclude(a, b);
  if (!model.staticParentsCollide)
    for (std::size_t i = 0; i < model.links.size(); ++i)
      if (!model.links[i].dofs.empty() && rootOf(layout, model.links[i].parent) < 0)
        exclude(static_cast<int>(i), model.links[i].parent);
  scene.exclusions.assign(pairs.begin(), pairs.end());
  named.tell(model, report);
}

}  // namespace rubble::convert
