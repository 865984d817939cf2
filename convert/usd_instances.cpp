/// UsdGeomPointInstancer: copies of prototypes, each with its bodies, at
/// prototype, scale, orientation, position, instancer, from the right to the left in Affine.
#include <algorithm>
#include <numbers>

#include <rubble/error.h>

#include "convert/usd_reader.h"

namespace rubble::convert {
namespace {

const usd::Prim* primAt(const usd::Prim& root, const std::string& path) {
  const usd::Prim* prim = &root;
  for (std::size_t begin = 1; prim && begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    prim = prim->child(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return prim;
}

}  // namespace

void UsdReader::addInstances(const usd::Prim& prim, const std::string& path, const Affine& world, int link) {
  const UsdPrim own = at(prim);
  const auto* targets = own.targets("prototypes");
  const auto* indices = own.list("protoIndices");
  if (!targets || !indices)
    return report_.note(Effect::Lost, own.place(), "PointInstancer" + inQuotes(prim.name),
                        "an instancer without prototypes");
  const std::size_t count = indices->size();
  const auto listOf = [&](const char* key, std::size_t each) -> const std::vector<double>* {
    const auto* const list = own.list(key);
    if (!list || list->empty()) return nullptr;
    if (list->size() != count * each)
      own.fail(key, std::to_string(each) + " numbers for each instance", std::to_string(list->size()));
    return list;
  };
  const auto *positions = listOf("positions", 3), *scales = listOf("scales", 3),
             *velocities = listOf("velocities", 3), *spins = listOf("angularVelocities", 3);
  const auto* turns = listOf("orientationsf", 4);
  if (!turns) turns = listOf("orientations", 4);
  own.list("ids"), own.list("invisibleIds"), own.list("accelerations");
  const auto vectorAt = [](const std::vector<double>* list, std::size_t i, const Vec3& otherwise) {
    return list ? Vec3{(*list)[3 * i], (*list)[3 * i + 1], (*list)[3 * i + 2]} : otherwise;
  };
  std::vector<const usd::Prim*> prototypes;
  for (const std::string& target : *targets) prototypes.push_back(primAt(*stage_, target));
  const int outer = instance_;
  for (std::size_t i = 0; i < count; ++i) {
    const double index = (*indices)[i];
    if (!(index >= 0 && index < static_cast<double>(prototypes.size())))
      own.fail("protoIndices", "indices of prototypes", std::to_string(index));
    const auto which = static_cast<std::size_t>(index);
    if (!prototypes[which]) own.fail("prototypes", "prims that are there", (*targets)[which]);
    Quat turn;
    if (turns) {
      const auto c = [&](std::size_t k) { return (*turns)[4 * i + k]; };
      turn = {c(0), c(1), c(2), c(3)};
      if (!(turn.s * turn.s + lengthSquared(turn.v) > 1e-12)) turn = {};
    }
    const Affine place = world * Affine::of({vectorAt(positions, i, {}), normalize(turn)}) *
                         Affine::scaling(vectorAt(scales, i, {1, 1, 1}));
    const std::size_t before = model_.links.size();
    const std::string name = path + "/" + prototypes[which]->name + "_" + std::to_string(i);
    for (int each = outer; each >= 0; each = instances_[static_cast<std::size_t>(each)].outer)
      if (instances_[static_cast<std::size_t>(each)].prototype == (*targets)[which])
        own.fail("prototypes", "instancers without a cycle", (*targets)[which]);
    instance_ = static_cast<int>(instances_.size());
    instances_.push_back({(*targets)[which], name, outer});
    placeAll(*prototypes[which], name, place, link);
    for (std::size_t k = before; k < model_.links.size(); ++k) {
      model_.links[k].velocity += world.direction(vectorAt(velocities, i, {}));
      model_.links[k].angularVelocity += std::numbers::pi / 180 *
                                         rotate(world.rigid().q, vectorAt(spins, i, {}));
    }
  }
  instance_ = outer;
  report_.converted(own.place(), "PointInstancer" + inQuotes(prim.name),
                    std::to_string(count) + " instances");
}

std::string UsdReader::inInstance(const Placed& from, const std::string& target) const {
  for (int i = from.instance; i >= 0; i = instances_[static_cast<std::size_t>(i)].outer) {
    const Instance& each = instances_[static_cast<std::size_t>(i)];
    if (target == each.prototype || target.starts_with(each.prototype + "/"))
      return each.path + target.substr(each.prototype.size());
  }
  return target;
}

}  // namespace rubble::convert
