#pragma once
/// Row blocks of every type, seen alike: which bodies they act on.
#include "stages/joints.h"

namespace rubble::RUBBLE_CORE {

/// visit(body, side, other) for the dynamic bodies of a block between a and b.
template <class Visit>
RUBBLE_HD void visitSides(const View& s, int a, int b, Visit&& visit) {
  const bool da = isDynamic(s, a), db = isDynamic(s, b);
  if (da) visit(a, 0, db ? b : -1);
  if (db) visit(b, 1, da ? a : -1);
}

/// The two bodies of a row block of type T (ContactRows or a joint), if it acts in this step.
struct BlockBodies {
  int a, b;
  bool acts;
};
struct ContactBlocks {
  static constexpr int kType = kContactType;
  RUBBLE_HD static BlockBodies bodies(const View& s, int i) { return {s.contact[i].a, s.contact[i].b, true}; }
  /// Level of the groups at which it unites its bodies.
  RUBBLE_HD static int joinLevel(const View& s, int i) { return s.joinLevel[i]; }
};
template <class F>
struct JointBlocks {
  static constexpr int kType = typeIndex<F>(JointTypes{}) + 1;
  RUBBLE_HD static BlockBodies bodies(const View& s, int i) {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    return {spec.a, spec.b, active<F>(s, i)};
  }
  RUBBLE_HD static int joinLevel(const View& s, int i) {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    return !spec.holds || spec.a == kWorldBody || spec.b == kWorldBody ? kCoarseLevels : finestSharedLevel(s, spec.a, spec.b);
  }
};

}  // namespace rubble::RUBBLE_CORE
