#pragma once
/// The list of elements between vertices. A new element needs its header, one entry here and an array in
/// state/solver_data.h.
#include "forces/bending.h"
#include "forces/forces.h"
#include "forces/membrane.h"
#include "forces/neo_hookean.h"
#include "forces/point_contact.h"
#include "forces/pressure.h"
#include "forces/spring.h"

namespace rubble::RUBBLE_CORE {

using ElementTypes = TypeList<Tetrahedron, Membrane, FlatBend, FoldBend, LineBend, Spring, Pressure>;

/// Does an element apply external loads? Whole objects and clusters must then sum it per vertex. All other
/// elements are invariant under their rigid motion.
template <class F> inline constexpr bool kIsLoad = requires { F::kIsLoad; };

/// Loads come last, so that they are at the end of the element list of each vertex.
inline constexpr int kFirstLoad = typeIndex<Pressure>(ElementTypes{});
static_assert(kFirstLoad == ElementTypes::kSize - 1 && kIsLoad<Pressure> && !kIsLoad<Spring>);

}  // namespace rubble::RUBBLE_CORE
