#include "forces/element_kind.h"

#include <algorithm>

#include "forces/soft_model.h"

namespace rubble {

namespace {

struct InElement {
  template <class Owner, class Def> static auto& owner(Def& def) { return ownIn<Owner>(def.fields); }
};

template <class F> ElementKind describeElement() {
  using Model = typename F::Model;
  ElementKind kind{F::kName, F::kDoc, F::kCorners, anyFields<ElementDef, F, InElement>(), nullptr, nullptr};
  kind.hasFields = [](const ElementDef& def) {
    return !def.fields.has_value() || def.fields.type() == typeid(Model);
  };
  kind.add = [](SoftModel& to, const ElementDef& def) {
    Model model = ownIn<Model>(def.fields);
    std::copy(def.vertices.begin(), def.vertices.end(), model.v.begin());
    to.list<Model>().push_back(model);
  };
  return kind;
}

template <class... F> std::vector<ElementKind> describeElements(TypeList<F...>) {
  std::vector<ElementKind> kinds;
  const auto add = [&]<class E>() {
    if constexpr (requires { E::kFields; }) kinds.push_back(describeElement<E>());
  };
  (add.template operator()<F>(), ...);
  return kinds;
}

}  // namespace

const std::vector<ElementKind>& elementKinds() {
  static const std::vector<ElementKind> kinds = describeElements(host::ElementTypes{});
  return kinds;
}

const ElementKind* findElementKind(const std::string& name) {
  const auto found = std::find_if(elementKinds().begin(), elementKinds().end(),
                                  [&](const ElementKind& kind) { return kind.name == name; });
  return found == elementKinds().end() ? nullptr : &*found;
}

}  // namespace rubble
