// From what is seen to its normal, color and finish. target0: square root of the albedo; finish / 8, 0 for the sky. target1: normal; wear
// of the surface, which roughens it.
#include "pose.glsl"
#include "view.glsl"
#include "pack.glsl"
#include "pixels.glsl"
uniform usampler2D seenBodies;
uniform sampler2D depths;
uniform float pixelAngle;  // size of a pixel at view depth 1 [m]
uniform float gridCell;    // of the lines on planes [m]
uniform int selected;      // slot + 1, or 0
uniform float heatStops[18];

const int kStone = 1, kMetal = 2, kPlastic = 3, kGround = 4, kCloth = 5, kPaint = 6;

float hash(vec3 p) {
  p = fract(p * vec3(0.1031, 0.1030, 0.0973));
  p += dot(p, p.yxz + 33.33);
  return fract((p.x + p.y) * p.z);
}

float noise(vec3 p) {
  vec3 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  vec4 low = vec4(hash(i), hash(i + vec3(1, 0, 0)), hash(i + vec3(0, 1, 0)), hash(i + vec3(1, 1, 0)));
  vec4 high = vec4(hash(i + vec3(0, 0, 1)), hash(i + vec3(1, 0, 1)), hash(i + vec3(0, 1, 1)), hash(i + vec3(1, 1, 1)));
  vec4 z = mix(low, high, f.z);
  vec2 y = mix(z.xy, z.zw, f.y);
  return mix(y.x, y.y, f.x);
}

// How much of a pixel a line covers that runs every `cell`.
float lineCover(float at, float cell, float width, float pixel) {
  float away = abs(at - cell * round(at / cell));
  float soft = max(pixel, 1e-6);
  return clamp((width + 0.5 * soft - away) / soft, 0.0, 1.0) * min(1.0, width / soft + 0.25);
}

float gridLines(vec2 p, float footprint) {
  float fine = max(lineCover(p.x, gridCell, 0.004 * gridCell, footprint), lineCover(p.y, gridCell, 0.004 * gridCell, footprint));
  float coarse = max(lineCover(p.x, 10.0 * gridCell, 0.008 * gridCell, footprint), lineCover(p.y, 10.0 * gridCell, 0.008 * gridCell, footprint));
  fine *= 1.0 - smoothstep(0.05, 0.25, footprint / gridCell);
  coarse *= 1.0 - smoothstep(0.5, 2.5, footprint / gridCell);
  return max(0.45 * fine, coarse);
}

vec3 heatColor(float heat) {
  float at = heat * 5.0;
  int stop = min(int(at), 4);
  vec3 a = vec3(heatStops[3 * stop], heatStops[3 * stop + 1], heatStops[3 * stop + 2]);
  vec3 b = vec3(heatStops[3 * stop + 3], heatStops[3 * stop + 4], heatStops[3 * stop + 5]);
  return mix(a, b, at - float(stop));
}

void shade() {
  ivec2 pixel = ivec2(pixelCenter);
  uvec2 seen = texelFetch(seenBodies, pixel, 0).xy;
  if (seen.x == 0u) {
    target0 = vec4(0.0);
    target1 = vec4(0.0);
    return;
  }
  int slot = int(seen.x - 1u);
  vec4 size = texelFetch(looks, 2 * slot);
  vec4 look = texelFetch(looks, 2 * slot + 1);
  vec3 center = texelFetch(poses, 2 * slot).xyz;
  vec4 q = texelFetch(poses, 2 * slot + 1);
  float z = viewDepth(texelFetch(depths, pixel, 0).x);
  vec3 ray = rayAt(uv);
  vec3 position = eye + ray * z;
  vec3 local = turnedBack(q, position - center);
  int code = int(look.w + 0.5), finish = code & 7;
  bool isBox = (code & 8) != 0, isRound = (code & 16) != 0;
  float footprint = pixelAngle * z;
  vec3 albedo = look.rgb, normal;
  float wear = 0.0;

  if (isBox) {
    vec3 inside = size.xyz - abs(local), side = sign(local);
    vec3 face = inside.x < inside.y ? (inside.x < inside.z ? vec3(1, 0, 0) : vec3(0, 0, 1))
                                    : (inside.y < inside.z ? vec3(0, 1, 0) : vec3(0, 0, 1));
    // A rounded edge, as far as pixels are small enough to show it.
    float smallest = min(size.x, min(size.y, size.z));
    float bevel = 0.085 * smallest;
    float shown = 1.0 - smoothstep(0.6, 1.6, footprint / bevel);
    vec3 closeness = clamp(1.0 - max(inside, 0.0) / bevel, 0.0, 1.0) * (1.0 - face);
    vec3 bent = face + closeness * closeness * 0.75 * shown;
    normal = turned(q, normalize(bent * side));
    wear = max(closeness.x, max(closeness.y, closeness.z)) * shown;
    // Far away the gaps between neighbors are below a pixel: a rim keeps them apart.
    float rim = min(inside.x + face.x * 1e9, min(inside.y + face.y * 1e9, inside.z + face.z * 1e9));
    float tiny = smoothstep(0.02, 0.08, footprint / smallest) * (1.0 - smoothstep(0.3, 0.9, footprint / smallest));
    albedo *= 1.0 - 0.42 * tiny * (1.0 - clamp(rim / (1.2 * footprint) - 0.2, 0.0, 1.0));
  } else if (finish == kGround) {
    normal = turned(q, vec3(0.0, 0.0, 1.0));
    float slant = max(0.04, abs(dot(normal, normalize(ray))));
    vec2 cells = floor(local.xy / gridCell);
    float near = 1.0 - smoothstep(0.05, 0.4, footprint / sqrt(slant) / gridCell);
    albedo *= 1.0 - 0.13 * near * mod(cells.x + cells.y, 2.0);
    albedo *= 1.0 - 0.30 * gridLines(local.xy, footprint / sqrt(slant)) * smoothstep(0.04, 0.16, slant);
  } else {
    float heat = 0.0;
    normal = (code & 32) != 0 ? unpackHeat(seen.y, heat) : unpackNormal(seen.y);
    if ((code & 64) != 0) albedo = heatColor(heat);
    // A mesh that is seen from behind is lit from there. Round bodies have no such side, and of what deforms
    // normals are smooth over edges, so that they may look away.
    float away = dot(normal, normalize(ray));
    bool isRigidMesh = !isRound && (code & 32) == 0;
    if (finish == kCloth ? away > 0.0 : isRigidMesh && away > 0.1) normal = -normal;
    // Sectors in two shades make rolling visible. What has a color of its own has that alone.
    if (isRound && finish != kPaint) {
      float sectors = (local.x > 0.0 ? 1.0 : 0.0) + (local.y > 0.0 ? 1.0 : 0.0) + (local.z > 0.0 && size.w == 0.0 ? 1.0 : 0.0);
      albedo *= mod(sectors, 2.0) < 0.5 ? 1.0 : (finish == kMetal ? 0.80 : 0.72);
    }
  }

  if (finish == kStone) {
    float grain = max(size.x, max(size.y, size.z)) * 0.5;
    vec3 p = local / grain + float(slot % 977) * vec3(3.1, 1.7, 2.3);
    float detail = 1.0 - smoothstep(0.1, 0.5, footprint / grain);
    if (detail > 0.0) {
      float cloud = noise(p * 3.0) - 0.5, speck = noise(p * 19.0) - 0.5;
      float fine = 1.0 - smoothstep(0.01, 0.05, footprint / grain);
      albedo *= 1.0 + detail * (0.16 * cloud + 0.14 * fine * speck);
    }
    albedo *= 1.0 + 0.10 * wear;
    // land and large meshes are mottled, so that one sees them go by
    if (!isBox && !isRound) albedo *= 1.0 + 0.30 * (noise(position * 0.35) - 0.5);
  }
  if (selected != 0 && int(seen.x) == selected) albedo = mix(albedo, vec3(1.0, 0.55, 0.08), 0.6);
  target0 = vec4(sqrt(clamp(albedo, 0.0, 1.0)), float(finish) / 8.0);
  target1 = vec4(normal, wear);
}
#include "pixels_end.glsl"
