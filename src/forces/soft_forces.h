#pragma once
/// The list of elements between vertices. A new element needs its header and one entry here. An element F
/// declares
///
///   kName, kCorners, kHasDual   name; number of vertices; has it multipliers?
///   kIsLoad                     true: it applies external loads (optional)
///   v, alive                    vertices; 0 once it is torn
///   Model, set(const Model&)    its constants as they are cooked, in double precision, and their copy
///   begin, energy, accumulate   at x^t; energy of a step [J]; force and Hessian of a corner
///   updateDual, finish          dual update; does it tear in this step? (kHasDual)
///   accumulateGroupHessian      of a cluster of its vertices (forces/group_accumulation.h; optional)
#include "forces/bending.h"
#include "forces/forces.h"
#include "forces/membrane.h"
#include "forces/neo_hookean.h"
#include "forces/point_contact.h"
#include "forces/pressure.h"
#include "forces/spring.h"

namespace rubble {

// Flags of the vertices of an object.
/// Collision with bodies; as a sphere with other such vertices; with the surfaces of other such objects; with
/// the surface of its own object.
inline constexpr int kCollidesWithBodies = 1, kCollidesWithParticles = 2, kCollidesWithSurfaces = 4,
                     kCollidesWithSelf = 8;
/// The surface is closed, counter-clockwise seen from outside.
inline constexpr int kHasInside = 16;

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

/// Does an element apply external loads? Whole objects and clusters must then sum it per vertex. All other
/// elements are invariant under their rigid motion.
template <class F> inline constexpr bool kIsLoad = requires { F::kIsLoad; };

/// The types of a list that are loads, or that are not.
template <bool loads, class Found, class... F> struct SelectLoads { using Type = Found; };
template <bool loads, class... Found, class F, class... Rest>
struct SelectLoads<loads, TypeList<Found...>, F, Rest...>
    : SelectLoads<loads, std::conditional_t<kIsLoad<F> == loads, TypeList<Found..., F>, TypeList<Found...>>,
                  Rest...> {};
template <class A, class B> struct Concatenate;
template <class... A, class... B> struct Concatenate<TypeList<A...>, TypeList<B...>> {
  using Type = TypeList<A..., B...>;
};
/// Loads last, so that they are at the end of the element list of each vertex.
template <class... F>
using LoadsLast = typename Concatenate<typename SelectLoads<false, TypeList<>, F...>::Type,
                                       typename SelectLoads<true, TypeList<>, F...>::Type>::Type;

using ElementTypes = LoadsLast<Tetrahedron, Membrane, FlatBend, FoldBend, LineBend, Spring,
                               Pressure RUBBLE_EXTRA_ELEMENTS>;

template <class... F> constexpr int countLoads(TypeList<F...>) { return (kIsLoad<F> + ... + 0); }
inline constexpr int kFirstLoad = ElementTypes::kSize - countLoads(ElementTypes{});

}  // namespace rubble::RUBBLE_CORE
