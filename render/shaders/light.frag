// Sun, sky and what they reflect from; a filmic curve at the end.
// ONE_SAMPLE: writes the bytes to be shown, and their brightness. Else adds this sample to the linear light of the picture.
#include "pixels.glsl"
#include "bytes.glsl"
#include "view.glsl"
uniform sampler2D colors;
uniform sampler2D shadedNormals;
uniform sampler2D depths;
uniform sampler2D occlusion;
uniform sampler2DArrayShadow shadowMaps;
uniform mat4 toShadow[4];
uniform float shadowTexel[4];  // [m]
uniform int shadowMapCount;
uniform int shadowTaps;
uniform float shadowSoftness;  // radius of the filter [m]
uniform vec3 toSun;
uniform vec3 sunlight;         // factor on kSun
uniform float skylight;        // factor on the light from all around
uniform float lamps[6 * 16];   // position [m] and light at one meter of each
uniform int lampCount;
uniform vec3 up;
uniform float fadeDistance;    // where planes turn into the horizon [m]
uniform float weight;          // of this sample in the picture
uniform float turn;
uniform vec4 background;       // in place of the sky; a: 1 if there is one
uniform bool transparent;      // sky and planes leave no light

const vec3 kSun = vec3(3.00, 2.66, 2.20);
const vec3 kLamp = vec3(2.71);  // of the brightness of kSun
const vec3 kSky = vec3(0.62, 0.67, 0.75);
const vec3 kBounce = vec3(0.66, 0.60, 0.53);
const vec3 kHorizon = vec3(1.02, 1.03, 1.04);
const vec3 kZenith = vec3(0.50, 0.66, 0.86);
const vec3 kDepth = vec3(0.44, 0.43, 0.42);  // far below the horizon, where no ground is drawn
const float kExposure = 0.46;

float pattern(vec2 p) { return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715)))); }

vec3 sky(vec3 direction) {
  float height = dot(direction, up);
  return skylight * mix(mix(kHorizon, kDepth, smoothstep(0.0, -0.7, height)), kZenith, smoothstep(-0.02, 0.75, height));
}

// What a mirror sees: the sky above, the ground below.
vec3 surroundings(vec3 direction) {
  float height = dot(direction, up);
  return mix(skylight * kBounce * mix(1.6, 0.7, smoothstep(-0.1, -0.9, height)), sky(direction) * 1.3, smoothstep(-0.10, 0.06, height));
}

float sunSeen(vec3 position, vec3 normal) {
  for (int i = 0; i < shadowMapCount; ++i) {
    float offset = shadowTexel[i] * (1.0 + 1.5 * (1.0 - dot(normal, toSun)));
    vec3 at = (toShadow[i] * vec4(position + normal * offset, 1.0)).xyz;
    // Below all bodies there is still their shadow.
    float depth = min(at.z, 1.0);
    float margin = 3.0 / float(textureSize(shadowMaps, 0).x);
    if (any(lessThan(at.xy, vec2(margin))) || any(greaterThan(at.xy, vec2(1.0 - margin)))) continue;
    float texels = max(1.1, shadowSoftness / shadowTexel[i]) / float(textureSize(shadowMaps, 0).x);
    float angle = 6.2831853 * fract(pattern(pixelCenter) + turn);
    float sum = 0.0;
    for (int k = 0; k < shadowTaps; ++k) {
      float r = sqrt((float(k) + 0.5) / float(shadowTaps)) * texels;
      float a = angle + 2.399963 * float(k);
      sum += texture(shadowMaps, vec4(at.xy + r * vec2(cos(a), sin(a)), float(i), depth));
    }
    return sum / float(shadowTaps);
  }
  return 1.0;
}

float skySeen(float z) {
  // The nearest texel in depth: at an outline the pixel's own texel may belong to another body.
  vec4 open = textureGather(occlusion, uv, 0), apart = abs(textureGather(occlusion, uv, 1) - z);
  vec2 low = apart.x < apart.y ? vec2(apart.x, open.x) : vec2(apart.y, open.y);
  vec2 high = apart.z < apart.w ? vec2(apart.z, open.z) : vec2(apart.w, open.w);
  return low.x < high.x ? low.y : high.y;
}

// Curve of a film (fit of Narkowicz, 2015).
vec3 film(vec3 x) {
  x *= kExposure;
  return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

struct Matter {
  vec3 normal, toward, albedo, fresnel;
  float nv, roughness;
  bool isMetal;
};

// What reaches the eye of `light` from one direction; `facing`: the cosine of its incidence, which `light` has already.
vec3 reflected(Matter m, vec3 toLight, float facing, vec3 light) {
  float nh = max(dot(m.normal, normalize(toLight - m.toward)), 0.0);
  float a2 = m.roughness * m.roughness * m.roughness * m.roughness;
  float bell = nh * nh * (a2 - 1.0) + 1.0;
  float gloss = a2 / (12.566 * bell * bell * mix(facing * m.nv, 1.0, 0.35));
  return light * (m.isMetal ? gloss * m.fresnel : m.albedo + 0.6 * gloss * m.fresnel);
}

vec3 lampLight(Matter m, vec3 position) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 6 * lampCount; i += 6) {
    vec3 way = vec3(lamps[i], lamps[i + 1], lamps[i + 2]) - position;
    vec3 toLamp = normalize(way);
    float facing = max(dot(m.normal, toLamp), 0.0);
    if (facing > 0.0) sum += reflected(m, toLamp, facing, kLamp * vec3(lamps[i + 3], lamps[i + 4], lamps[i + 5]) * facing / dot(way, way));
  }
  return sum;
}

vec3 horizonOr(vec3 shown) { return background.a > 0.0 ? background.rgb : shown; }

void put(vec3 shown) {
#ifdef ONE_SAMPLE
  vec3 bytes = displayed(shown);
  target0 = vec4(bytes, dot(bytes, vec3(0.30, 0.59, 0.11)));
#else
  target0 = vec4(shown, 1.0) * weight;
#endif
}

void shade() {
  ivec2 pixel = ivec2(pixelCenter);
  vec4 surface = texelFetch(colors, pixel, 0);
  vec3 ray = rayAt(uv);
  vec3 toward = normalize(ray);
  int finish = int(surface.a * 8.0 + 0.5);
  if (transparent && (finish == 0 || finish == 4)) {
    target0 = vec4(0.0);
    return;
  }
  if (finish == 0) {
    put(horizonOr(film(sky(toward))));
    return;
  }
  vec3 albedo = surface.rgb * surface.rgb;
  // the ground is lighter about the scene than before and behind it
  if (finish == 4) {
    float away = length(ray) * viewDepth(texelFetch(depths, pixel, 0).x) / fadeDistance;
    albedo *= 1.08 - 0.34 * smoothstep(0.0, 1.1, abs(away - 1.0));
  }
  vec4 shaded = texelFetch(shadedNormals, pixel, 0);
  vec3 normal = normalize(shaded.xyz);
  float z = viewDepth(texelFetch(depths, pixel, 0).x);
  vec3 position = eye + ray * z;
  float open = skySeen(z);
  float facing = max(dot(normal, toSun), 0.0);
  float sun = facing > 0.0 ? facing * sunSeen(position, normal) : 0.0;
  float height = dot(normal, up);

  bool isMetal = finish == 2;
  float roughness = isMetal ? 0.42 : finish == 3 || finish == 6 ? 0.40 : 0.82;
  float nv = max(dot(normal, -toward), 0.02);
  vec3 mirror = isMetal ? albedo : vec3(0.04);
  vec3 fresnel = mirror + (1.0 - mirror) * pow(1.0 - nv, 5.0) * (1.0 - roughness);

  // Light that is reflected within a crevice keeps the crevice's color (fit of Jimenez et al., 2016).
  vec3 glow = max(vec3(open), ((open * (2.0404 * albedo - 0.3324) + (-4.7951 * albedo + 0.6417)) * open + (2.7552 * albedo + 0.6903)) * open);
  vec3 ambient = skylight * mix(kBounce, kSky, 0.5 + 0.5 * height) * glow;
  vec3 mirrored = surroundings(reflect(toward, normal)) * fresnel * open * (isMetal ? 1.0 : 0.55);
  Matter matter = Matter(normal, toward, albedo, fresnel, nv, roughness, isMetal);
  vec3 lit = (isMetal ? vec3(0.0) : albedo * ambient) + mirrored + reflected(matter, toSun, facing, kSun * sunlight * sun) +
             lampLight(matter, position);

  // Planes end in the horizon; what stands far off is a little hazy.
  float far = length(position - eye) / fadeDistance;
  float haze = finish == 4 ? smoothstep(0.6, 5.0, far) : 0.45 * smoothstep(1.0, 9.0, far);
  put(background.a > 0.0 ? mix(film(lit), background.rgb, haze) : film(mix(lit, sky(toward), haze)));
}
#include "pixels_end.glsl"
