#pragma once
/// Definitions of bodies, joints and deformable objects from bytes. Most are reasonable; some are not.
#include <rubble/rubble.h>

#include "tests/fuzz/byte_source.h"

namespace rubble::fuzz {

Material material(ByteSource& in);
/// A shape that moves: convex, a compound or a distance field.
Shape solidShape(ByteSource& in);
/// Any shape, of which some are for static bodies only.
Shape anyShape(ByteSource& in);
BodyDef body(ByteSource& in);
/// Of any type, without its bodies.
JointDef joint(ByteSource& in);
/// Of at most some thirty vertices.
Deformable deformable(ByteSource& in);
/// Without its objects. `vertices`: of the object.
AttachmentDef attachment(ByteSource& in, int vertices, int otherVertices);

}  // namespace rubble::fuzz
