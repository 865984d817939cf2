// Takes the pattern out of the occlusion without carrying it over edges of depth.
uniform sampler2D occlusion;
uniform vec2 direction;  // one texel
#include "pixels.glsl"

void shade() {
  vec2 here = texture(occlusion, uv).xy;
  float sum = here.x, weights = 1.0;
  for (int i = -3; i <= 3; ++i) {
    if (i == 0) continue;
    vec2 there = texture(occlusion, uv + direction * float(i)).xy;
    float weight = max(0.0, 1.0 - 40.0 * abs(there.y - here.y) / here.y) * (1.0 - abs(float(i)) / 5.0);
    sum += weight * there.x;
    weights += weight;
  }
  target0 = vec4(sum / weights, here.y, 0.0, 0.0);
}
#include "pixels_end.glsl"
