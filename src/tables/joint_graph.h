#pragma once
/// The joints of each body.
#include <vector>

#include "state/joint_tables.h"

namespace rubble::RUBBLE_CORE {

/// A joint by its type and slot.
struct JointRef {
  int type, slot;
  auto operator<=>(const JointRef&) const = default;
};

/// Doubly linked lists, one for each body, of the sides of its joints. Edits cost the same at any number of
/// joints.
class JointGraph {
 public:
  void add(JointRef joint, int side, int body) {
    Link& link = linkOf(joint, side);
    if (body >= static_cast<int>(first_.size())) first_.resize(static_cast<std::size_t>(body) + 1, kNone);
    int& first = first_[static_cast<std::size_t>(body)];
    link = {body, kNone, first};
    if (first != kNone) linkAt(first).before = codeOf(joint, side);
    first = codeOf(joint, side);
  }
  void remove(JointRef joint, int side) {
    Link& link = linkOf(joint, side);
    if (link.body < 0) return;
    (link.before == kNone ? first_[static_cast<std::size_t>(link.body)]
                          : linkAt(link.before).after) = link.after;
    if (link.after != kNone) linkAt(link.after).before = link.before;
    link = {};
  }
  void clear() {
    first_.clear();
    for (std::vector<Link>& links : links_) links.clear();
  }
  /// Calls visit(joint) for every side of a joint that is this body.
  template <class Visit> void forEachJoint(int body, Visit&& visit) const {
    if (body >= static_cast<int>(first_.size())) return;
    for (int code = first_[static_cast<std::size_t>(body)]; code != kNone;
         code =
             links_[static_cast<std::size_t>(code % kTypes)][static_cast<std::size_t>(code / kTypes)].after)
      visit(JointRef{code % kTypes, code / kTypes / kMostSides});
  }
  bool hasJoints(int body) const {
    return body < static_cast<int>(first_.size()) && first_[static_cast<std::size_t>(body)] != kNone;
  }

  static constexpr int kMostSides = 4;

 private:
  static constexpr int kNone = -1, kTypes = JointTypes::kSize;
  /// A side of a joint in the list of its body.
  struct Link {
    int body = -1, before = kNone, after = kNone;
  };

  static int codeOf(JointRef joint, int side) {
    return (joint.slot * kMostSides + side) * kTypes + joint.type;
  }
  Link& linkAt(int code) {
    return links_[static_cast<std::size_t>(code % kTypes)][static_cast<std::size_t>(code / kTypes)];
  }
  Link& linkOf(JointRef joint, int side) {
    std::vector<Link>& links = links_[static_cast<std::size_t>(joint.type)];
    const std::size_t slot = static_cast<std::size_t>(joint.slot);
    if (links.size() <= slot * kMostSides + kMostSides - 1) links.resize((slot + 1) * kMostSides);
    return linkAt(codeOf(joint, side));
  }

  std::vector<int> first_;
  std::vector<Link> links_[JointTypes::kSize];
};

}  // namespace rubble::RUBBLE_CORE
