#pragma once
/// Single definitions as JSON text, with the keys of scene files (docs/scene_format.md). Every reader throws
/// Error with the path of the first fault. A path begins with that of the definition.
#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <rubble/rod.h>
#include <rubble/scene.h>
#include <rubble/world.h>

#include "io/json_reader.h"

namespace rubble::io {

/// The error that a fault stands for, with its three parts where its message has them.
Error errorOf(const Fault& fault);
/// Parses the text, calls read(node) and throws Error for the first fault, if there is one.
void readDefinition(const std::string& text, const std::string& path,
                    const std::function<void(const Node&)>& read);

BodyDef parseBody(const std::string& text, const std::string& path = "body");
/// Values of a body that replace those of `body`: {"mass": 2, "material": {"friction": 0.5}}. Without "shape"
/// the shape stays the same object.
void parseBodyValues(const std::string& text, BodyDef& body, const std::string& path = "body");
MaterialPair parseMaterialPair(const std::string& text, const std::string& path = "pair");
/// Values of a deformable object that replace those of `object`, likewise.
void parseDeformableValues(const std::string& text, Deformable& object,
                           const std::string& path = "deformable");
/// A list of bodies.
std::vector<BodyDef> parseBodies(const std::string& text, const std::string& path = "bodies");
Shape parseShape(const std::string& text, const std::string& path = "shape");
/// Mesh files lie in `folder`, unless a full path is given.
Deformable parseDeformable(const std::string& text, const std::string& folder = "",
                           const std::string& path = "deformable");
/// A joint without "body_a", "body_b" and their frame bodies: the four are `bodies` (kWorld or an index into
/// the bodies of `around`, which stand where "anchor", "axis" and "frame" are to be read).
JointDef parseJoint(const std::string& text, const Scene& around, const std::array<int, 4>& bodies,
                    const std::string& path = "joint");
/// Values of a joint (stiffnesses, limits, drives, frames on the bodies) that replace those of `joint`.
void parseJointValues(const std::string& text, JointDef& joint, const std::string& path = "joint");
/// A gear or a rack between the first two joints of `around`, with "type", "name" and values.
JointDef parseCoupling(const std::string& text, const Scene& around, const std::string& path = "joint");
/// An attachment without "object", "body" and "other_object".
AttachmentDef parseAttachment(const std::string& text, const std::string& path = "attachment");
/// A rod: keys like the members of RodDef, in snake case. "start" and "end" are indices into the bodies of
/// the scene, or "world".
RodDef parseRod(const std::string& text, const std::string& path = "rod");
/// "backend", "threads", "preset", "timings", "events", "instruction_set", and parameters by name
/// (snake case).
WorldOptions parseOptions(const std::string& text, const std::string& path = "options");
/// Parameters by name (snake case) that replace those of `params`.
void parseParams(const std::string& text, Params& params, const std::string& path = "params");

/// Definitions as text. References to bodies are indices.
std::string toJson(const BodyDef& body);
std::string toJson(const JointDef& joint);
std::string toJson(const Deformable& deformable);
std::string toJson(const Params& params);
std::string toJson(const Material& material);
std::string toJson(std::span<const MaterialPair> pairs);

/// Name of a parameter in files: "sort_interval" of "sortInterval".
std::string parameterKey(const std::string& name);

}  // namespace rubble::io
