// Linear light to sRGB, with half a byte of a fixed pattern, so that the sky has no bands.
vec3 displayed(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  vec3 bytes = mix(12.92 * c, 1.055 * pow(max(c, 1e-6), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
  float pattern = fract(52.9829189 * fract(dot(pixelCenter, vec2(0.06711056, 0.00583715))));
  return bytes + (pattern - 0.5) / 255.0;
}
