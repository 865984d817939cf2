#pragma once
/// The list of elements between vertices. A new element is its header, one entry here and an array in view.h.
#include "forces/bending.h"
#include "forces/forces.h"
#include "forces/membrane.h"
#include "forces/neo_hookean.h"
#include "forces/point_contact.h"
#include "forces/spring.h"

namespace rubble::RUBBLE_CORE {

using ElementTypes = TypeList<Tetrahedron, Membrane, FlatBend, FoldBend, LineBend, Spring>;

}  // namespace rubble::RUBBLE_CORE
