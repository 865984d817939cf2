#ifdef COMPUTE
uniform ivec2 targetSize;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, targetSize))) return;
  pixelCenter = vec2(pixel) + 0.5;
  uv = pixelCenter / vec2(targetSize);
  shade();
#ifdef ADDED
  target0 += imageLoad(image0, pixel);
#endif
  imageStore(image0, pixel, target0);
#ifdef TWO_TARGETS
  imageStore(image1, pixel, target1);
#endif
}
#else
void main() { shade(); }
#endif
