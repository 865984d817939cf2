// Boxes without triangles: rays through the centres of pixels against boxes, one thread a small box (LISTED: many threads a box of a list).
// Two passes: the first keeps the least depth of each pixel, the second the least slot with that depth, so that the picture depends neither
// on the order of boxes nor on what was drawn before.
// PARALLEL: the rays of the sun.
#include "pose.glsl"
#include "boxes.glsl"
#include "boxes_list.glsl"
layout(local_size_x = 64) in;
uniform int boxCount;        // slots of boxes; they come first
uniform bool naming;         // the second pass
uniform mat4 viewProjection;
uniform ivec2 pixels;
// Ray of a pixel: rayOrigin + t rayDirection, with what a pixel to the right and one upwards add.
uniform vec3 rayOrigin, rayOriginX, rayOriginY;
uniform vec3 rayDirection, rayDirectionX, rayDirectionY;
uniform float nearest;       // view depth at which the picture begins [m]; 0 if parallel
uniform float slopeOffset;   // parallel: added to a depth, in what it changes by from pixel to pixel
uniform int listOffset;      // LISTED: of this list
uniform int listIndex;

const int kSmall = 96, kMiddling = 4096;  // pixels within the bounds of a box

// A box on the screen: rays in its own frame, in which it reaches from -1 to 1.
struct Box {
  vec3 origin, originX, originY, direction, directionX, directionY;
  ivec2 low, high;  // pixels, both within
};

bool place(uint slot, out Box box) {
  precise vec3 centre = texelFetch(poses, int(2u * slot)).xyz;
  if (!(abs(centre.x) < 1e17)) return false;
  precise vec4 q = texelFetch(poses, int(2u * slot + 1u));
  precise vec3 size = max(texelFetch(looks, int(2u * slot)).xyz, vec3(1e-9));
  precise vec3 x = turned(q, vec3(1.0, 0.0, 0.0)), y = turned(q, vec3(0.0, 1.0, 0.0)), z = turned(q, vec3(0.0, 0.0, 1.0));

  vec4 middle = viewProjection * vec4(centre, 1.0);
  vec4 a = viewProjection * vec4(size.x * x, 0.0), b = viewProjection * vec4(size.y * y, 0.0), c = viewProjection * vec4(size.z * z, 0.0);
  vec2 low = vec2(1e30), high = vec2(-1e30);
  int ahead = 0;
  for (int i = 0; i < 8; ++i) {
    vec4 corner = middle + ((i & 1) == 0 ? -a : a) + ((i & 2) == 0 ? -b : b) + ((i & 4) == 0 ? -c : c);
    if (corner.w < nearest) continue;
    ++ahead;
    low = min(low, corner.xy / corner.w);
    high = max(high, corner.xy / corner.w);
  }
  if (ahead == 0) return false;
  // Of a box that reaches behind the eye the bounds are not known.
  if (ahead < 8) {
    low = vec2(-1.0);
    high = vec2(1.0);
  }
  const float kSlack = 0.01;  // pixels, for rounding
  vec2 across = vec2(pixels);
  box.low = ivec2(ceil(clamp((low * 0.5 + 0.5) * across - 0.5 - kSlack, vec2(0.0), across)));
  box.high = ivec2(floor(clamp((high * 0.5 + 0.5) * across - 0.5 + kSlack, vec2(-1.0), across - 1.0)));
  if (any(lessThan(box.high, box.low))) return false;

  precise mat3 toBox = transpose(mat3(x / size.x, y / size.y, z / size.z));
  precise vec3 origin = toBox * (rayOrigin - centre), direction = toBox * rayDirection;
  box.origin = origin;
  box.direction = direction;
#ifdef PARALLEL
  precise vec3 originX = toBox * rayOriginX, originY = toBox * rayOriginY;
  box.originX = originX;
  box.originY = originY;
#else
  precise vec3 directionX = toBox * rayDirectionX, directionY = toBox * rayDirectionY;
  box.directionX = directionX;
  box.directionY = directionY;
#endif
  return true;
}

void put(in Box box, ivec2 pixel, uint slot) {
  precise vec2 p = vec2(pixel);
#ifdef PARALLEL
  precise vec3 origin = box.origin + p.x * box.originX + p.y * box.originY, direction = box.direction;
#else
  precise vec3 origin = box.origin, direction = box.direction + p.x * box.directionX + p.y * box.directionY;
#endif
  direction = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  precise vec3 side = sign(direction), perUnit = 1.0 / direction;
  precise vec3 enters = (-side - origin) * perUnit, leaves = (side - origin) * perUnit;
  precise float from = max(max(enters.x, enters.y), enters.z), to = min(min(leaves.x, leaves.y), leaves.z);
  if (from > to) return;
#ifdef PARALLEL
  // Of the face where the ray enters.
  vec2 slope = from == enters.x ? vec2(box.originX.x, box.originY.x) * perUnit.x
             : from == enters.y ? vec2(box.originX.y, box.originY.y) * perUnit.y
                                : vec2(box.originX.z, box.originY.z) * perUnit.z;
  precise float depth = clamp(from + slopeOffset * max(abs(slope.x), abs(slope.y)), 0.0, 1.0);
#else
  if (from < nearest) return;
  precise float depth = 1.0 - nearest / from;
#endif
  uint bits = floatBitsToUint(depth), at = uint(pixel.y * pixels.x + pixel.x);
  if (naming) {
    if (bits == depthBits[at]) atomicMin(seenSlots[at], slot);
  } else if (bits < depthBits[at]) {
    atomicMin(depthBits[at], bits);
  }
}

int pixelsOf(in Box box) { return (box.high.x - box.low.x + 1) * (box.high.y - box.low.y + 1); }

#ifdef LISTED
void main() {
  uint count = listed[listIndex];
  for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
    uint slot = list[uint(listOffset) + i];
    Box box;
    if (!place(slot, box)) continue;
    int wide = box.high.x - box.low.x + 1, inside = pixelsOf(box);
    for (int k = int(gl_GlobalInvocationID.y * gl_WorkGroupSize.x + gl_LocalInvocationID.x); k < inside;
         k += int(gl_NumWorkGroups.y * gl_WorkGroupSize.x))
      put(box, box.low + ivec2(k % wide, k / wide), slot);
  }
}
#else
void main() {
  uint slot = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (slot >= uint(boxCount)) return;
  Box box;
  if (!place(slot, box)) return;
  int inside = pixelsOf(box);
  if (inside > kSmall) {
    if (naming) return;
    int size = inside > kMiddling ? 1 : 0;
    list[uint(size * boxCount) + atomicAdd(listed[size], 1u)] = slot;
    return;
  }
  for (int y = box.low.y; y <= box.high.y; ++y)
    for (int x = box.low.x; x <= box.high.x; ++x) put(box, ivec2(x, y), slot);
}
#endif
