/// What actuators of sites, ball joints and free joints act on: motions of a link along and about the axes of
/// their gear, as a tendon of their own.
#include <cmath>

#include "convert/mjcf_reader.h"
#include "convert/rotations.h"

namespace rubble::convert {
namespace {

using Motion = Tendon::Motion;

/// Adds a motion along or about `gear` in axes of `motion.axisLink`.
void add(Tendon& tendon, Motion motion, const Quat& axes, const Vec3& gear) {
  const double size = length(gear);
  if (!(size > 0)) return;
  motion.axis = rotate(axes, gear / size), motion.coefficient = size;
  tendon.motions.push_back(motion);
}

}  // namespace

MjcfTarget MjcfReader::targetOf(Tendon tendon, const Tag& tag, const std::string& what) {
  tendon.name = tag.name();
  tendon.place = tag.place();
  model_.tendons.push_back(std::move(tendon));
  MjcfTarget out;
  out.coordinate = &model_.tendons.back();
  out.tendon = static_cast<int>(model_.tendons.size()) - 1, out.isOfModel = false;
  out.what = what;
  return out;
}

MjcfTarget MjcfReader::targetOfSite(const Tag& tag, bool isPlain) {
  const MjcfSite& site = siteOf(tag, "site");
  const Vec3 along{gearOf(tag, 0)}, about{gearOf(tag, 3)};
  if (isPlain && !tag.has("refsite")) {
    MjcfTarget out;
    out.what = "site" + inQuotes(tag.need("site"));
    out.link = site.link, out.position = site.pose.p;
    out.force = rotate(site.pose.q, along), out.torque = rotate(site.pose.q, about);
    return out;
  }
  Motion travel;
  travel.link = travel.axisLink = site.link, travel.anchor = site.pose.p;
  Quat axes = site.pose.q;
  if (tag.has("refsite")) {
    const MjcfSite& reference = siteOf(tag, "refsite");
    travel.frame = travel.axisLink = reference.link, travel.origin = reference.pose.p;
    axes = reference.pose.q;
  } else {
    travel.start = 0;
  }
  Motion turn = travel;
  turn.turns = true;
  Tendon tendon;
  add(tendon, travel, axes, along);
  add(tendon, turn, axes, about);
  MjcfTarget out = targetOf(std::move(tendon), tag, "site" + inQuotes(tag.need("site")));
  out.hasLength = tag.has("refsite");
  report_.note(Effect::Approximate, tag.place(), tag.type() + ".site",
               out.hasLength ? "turns are those about the axis at the beginning"
                             : "the force keeps the direction in the world that it has at the beginning");
  return out;
}

MjcfTarget MjcfReader::targetOfTurns(const Tag& tag, int at, bool inParent, bool isPlain) {
  const Link& own = link(at);
  const Vec3 first = gearOf(tag, 0), second = gearOf(tag, 3);
  if (own.free && isPlain && !inParent && first == Vec3{}) {
    MjcfTarget out;
    out.what = "link" + inQuotes(own.name);
    out.link = at, out.torque = second;
    return out;
  }
  Motion turn;
  turn.link = at, turn.frame = own.parent, turn.turns = true;
  turn.axisLink = inParent ? own.parent : at;
  turn.start = 0;
  Tendon tendon;
  if (own.free) {
    Motion travel = turn;
    travel.turns = false, travel.axisLink = -1;
    add(tendon, travel, {}, first);
    add(tendon, turn, {}, second);
  } else {
    // the length of a ball joint is the part of its rotation vector along the gear
    const Quat& start = own.dofs.front().startTurn;
    const double size = length(first);
    if (size > 0)
      turn.start = dot(rotationVector(start), inParent ? rotateInverse(start, first) : first) / size;
    // the parent of the joint has the axes of the link in the pose of the file
    add(tendon, turn, inParent ? own.pose.q : Quat{}, first);
  }
  MjcfTarget out = targetOf(std::move(tendon), tag, "link" + inQuotes(own.name));
  out.hasLength = !own.free;
  if (!inParent)
    report_.note(Effect::Approximate, tag.place(), tag.type() + ".joint",
                 "a torque keeps the direction that it has at the beginning");
  return out;
}

}  // namespace rubble::convert
