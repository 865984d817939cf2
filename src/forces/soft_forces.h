#pragma once
/// The list of elements between vertices. A new element is its header, one incidence here and an array in
/// view.h.
#include "forces/bending.h"
#include "forces/forces.h"
#include "forces/membrane.h"
#include "forces/neo_hookean.h"
#include "forces/point_contact.h"
#include "forces/pressure.h"
#include "forces/spring.h"

namespace rubble::RUBBLE_CORE {

using ElementTypes = TypeList<Tetrahedron, Membrane, FlatBend, FoldBend, LineBend, Spring, Pressure>;

/// Does an element push its vertices from outside? Then it is counted by vertex in whole objects and clusters
/// too; others feel nothing of a rigid motion of theirs.
template <class F> inline constexpr bool kIsLoad = requires { F::kIsLoad; };

/// Loads are the last of the list, so that the elements of a vertex end with them.
inline constexpr int kFirstLoad = typeIndex<Pressure>(ElementTypes{});
static_assert(kFirstLoad == ElementTypes::kSize - 1 && kIsLoad<Pressure> && !kIsLoad<Spring>);

}  // namespace rubble::RUBBLE_CORE
