// A pass over all pixels: fragments of one triangle over the picture, or (COMPUTE) threads, of which a GPU made for computing runs far more.
// It is a function shade() that reads `uv` and `pixelCenter` and sets target0 (TWO_TARGETS: and target1); pixels_end.glsl calls it.
#ifdef COMPUTE
layout(local_size_x = 16, local_size_y = 8) in;
vec2 uv, pixelCenter;
vec4 target0;
#ifdef ADDED
layout(binding = 0, rgba32f) uniform image2D image0;
#else
layout(binding = 0) uniform writeonly image2D image0;
#endif
#ifdef TWO_TARGETS
vec4 target1;
layout(binding = 1) uniform writeonly image2D image1;
#endif
#else
in vec2 uv;
#define pixelCenter gl_FragCoord.xy
layout(location = 0) out vec4 target0;
#ifdef TWO_TARGETS
layout(location = 1) out vec4 target1;
#endif
#endif
