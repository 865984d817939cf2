// The picture as it is shown: from the linear light of many samples, or from that of one (ONE_SAMPLE), whose edges are smoothed along
// themselves.
#include "pixels.glsl"
#include "bytes.glsl"
uniform sampler2D lights;
uniform vec2 texel;

#ifdef ONE_SAMPLE
// Least difference in brightness that is an edge, absolute and over the brightness.
const float kEdge = 0.05, kRelativeEdge = 0.10;
const float kLongestBlur = 6.0;  // pixels

void shade() {
  // Brightness of the pixels to the south west and to the north east, both with the pixel itself.
  vec4 a = textureGather(lights, uv - 0.5 * texel, 3), b = textureGather(lights, uv + 0.5 * texel, 3);
  float low = min(min(min(a.x, a.y), min(a.z, a.w)), min(b.x, min(b.y, b.z)));
  float high = max(max(max(a.x, a.y), max(a.z, a.w)), max(b.x, max(b.y, b.z)));
  // Gathered are: x upper left, y upper right, z lower right, w lower left.
  float west = a.x, south = a.z, southWest = a.w, north = b.x, northEast = b.y, east = b.z;
  vec2 gradient = vec2(2.0 * (east - west) + northEast - southWest, 2.0 * (north - south) + northEast - southWest);
  vec2 along = vec2(-gradient.y, gradient.x);
  along /= max(min(abs(along.x), abs(along.y)), 0.125 * (abs(along.x) + abs(along.y))) + 1e-4;
  along = clamp(along, -kLongestBlur, kLongestBlur) * texel * (high - low < max(kEdge, kRelativeEdge * high) ? 0.0 : 1.0);
  vec4 near = 0.5 * (texture(lights, uv - along / 6.0) + texture(lights, uv + along / 6.0));
  vec4 wide = 0.5 * near + 0.25 * (texture(lights, uv - 0.5 * along) + texture(lights, uv + 0.5 * along));
  // A blur that brings in what is beyond the edge is too long.
  target0 = vec4(wide.a < low || wide.a > high ? near.rgb : wide.rgb, 1.0);
}
#else
uniform bool transparent;  // the picture has an alpha channel

void shade() {
  vec4 light = texture(lights, uv);
  target0 = transparent ? vec4(displayed(light.rgb / max(light.a, 1e-6)), light.a) : vec4(displayed(light.rgb), 1.0);
}
#endif
#include "pixels_end.glsl"
