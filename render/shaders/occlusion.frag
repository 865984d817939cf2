// How much of the sky a point sees past what stands about it: horizons in slices through the view ray, integrated over the cosine of
// the normal (Jimenez et al., Practical Realtime Strategies for Accurate Indirect Occlusion, 2016).
#include "view.glsl"
#include "pixels.glsl"
uniform sampler2D depths;
uniform sampler2D shadedNormals;
uniform vec2 pixelsAcross;   // of the depth picture
uniform float radius;        // how far occluders count [m]
uniform float pixelAngle;
uniform float turn;          // of the pattern, 0 to 1: differs from sample to sample

const int kSlices = 2, kSteps = 4;
const float kPi = 3.141592654;

float pattern(vec2 p) { return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715)))); }

vec3 pointAt(vec2 at) { return rayAt(at) * viewDepth(texture(depths, at).x); }

void shade() {
  // The center of one of the four pixels that this one stands for: between them rounding would choose.
  vec2 at = (2.0 * floor(pixelCenter) + 1.5) / pixelsAcross;
  float depth = texture(depths, at).x;
  if (depth >= 1.0) {
    target0 = vec4(1.0, 1e9, 0.0, 0.0);
    return;
  }
  float z = viewDepth(depth);
  vec3 normal = normalize(texture(shadedNormals, at).xyz);
  vec3 point = rayAt(at) * z;
  // Off the surface by what depth cannot tell apart.
  point += normal * (1.5 * pixelAngle * z);
  vec3 toEye = normalize(-point);
  float reach = clamp(radius / (pixelAngle * z), 3.0, 0.18 * pixelsAcross.y);
  float noiseA = fract(pattern(floor(pixelCenter)) + turn);
  float noiseB = fract(pattern(floor(pixelCenter.yx) + 17.0) + turn * 3.0);
  vec3 right = normalize(rightSpan), up = normalize(upSpan);
  float sum = 0.0;
  for (int slice = 0; slice < kSlices; ++slice) {
    float angle = kPi * (float(slice) + noiseA) / float(kSlices);
    vec2 across = vec2(cos(angle), sin(angle));
    vec3 direction = right * across.x + up * across.y;
    vec3 along = direction - toEye * dot(direction, toEye);
    vec3 axis = normalize(cross(along, toEye));
    vec3 inSlice = normal - axis * dot(normal, axis);
    float weight = length(inSlice);
    float tilt = sign(dot(along, inSlice)) * acos(clamp(dot(inSlice, toEye) / max(weight, 1e-5), -1.0, 1.0));
    vec2 low = cos(vec2(tilt - 0.5 * kPi, tilt + 0.5 * kPi));
    vec2 horizon = low;
    for (int i = 0; i < kSteps; ++i) {
      float part = (float(i) + noiseB) / float(kSteps);
      vec2 away = across * (1.0 + part * part * reach) / pixelsAcross;
      vec3 behind = pointAt(at - away) - point, ahead = pointAt(at + away) - point;
      vec2 far = vec2(dot(behind, behind), dot(ahead, ahead));
      vec2 cosines = vec2(dot(behind, toEye), dot(ahead, toEye)) * inversesqrt(far + 1e-12);
      vec2 near = clamp(2.0 - 2.0 * far / (radius * radius), 0.0, 1.0);
      horizon = max(horizon, mix(low, cosines, near));
    }
    vec2 h = acos(clamp(horizon, -1.0, 1.0)) * vec2(-1.0, 1.0);
    vec2 arc = cos(tilt) + 2.0 * h * sin(tilt) - cos(2.0 * h - tilt);
    sum += weight * 0.25 * (arc.x + arc.y);
  }
  target0 = vec4(clamp(sum / float(kSlices), 0.0, 1.0), z, 0.0, 0.0);
}
#include "pixels_end.glsl"
