// The normal that the surface is shaded by. The shader that includes it includes display/specular.glsl first.
#ifndef QUADGRAPH_SHADING_NORMAL_GLSL
#define QUADGRAPH_SHADING_NORMAL_GLSL

// Cosines with the surface that what is mirrored keeps, and that the surface itself must have for it.
const float LEAST_MIRRORED = 0.01, SHARE_MIRRORED = 0.9;

// Normal n leaned as the map says at `shape`, mm at rest; how `shape` and the place in the scene, mm, differ from pixel
// to pixel. `roughness` becomes what it is with all that the picture has within a pixel: the variance of slopes adds to
// half the square of alpha [Olano 2010].
//
// The slopes are of a height along the normal: with the gradients of the picture's coordinates on the surface
// (Mikkelsen 2010) the same is right on any side of the body, and where that is deformed.
vec3 mapped_normal(vec3 n, vec3 shape, vec3 shape_right, vec3 shape_below, vec3 to_right, vec3 to_below) {
  NormalMapRef map = SCENE.normal_map;
  vec3 place = in_box(map.box, shape);
  if (any(greaterThan(abs(place), map.box.half_size))) return n;
  vec3 along = cross(to_below, n), across = cross(n, to_right);
  float area = dot(to_right, along);
  if (area == 0.0) return n;
  float width = max(across_box(map.box, shape_right), across_box(map.box, shape_below));
  ImageTap tap = image_tap(map.image, in_picture(map.box, place), texels_across(map.box, map.image, width));
  vec3 texel = load_image(map.texels, tap);
  vec3 u = dot(map.box.right, shape_right) * along + dot(map.box.right, shape_below) * across;
  vec3 v = dot(map.box.up, shape_right) * along + dot(map.box.up, shape_below) * across;
  float spread = max(texel.z - texel.x * texel.x - texel.y * texel.y, 0.0);
  roughness = min(sqrt(roughness * roughness + map.strength * map.strength * spread), 1.0);
  return normalize(n + map.strength / area * (texel.x * u + texel.y * v));
}

// Normal n, bent as little as it takes that what a mirror would show along v lies above the triangle, of
// which `across` is a normal of any length and either sign (Keller et al. 2017, A.3).
vec3 seen_normal(vec3 n, vec3 across, vec3 v) {
  float size = length(across), towards = dot(across, v);
  if (size == 0.0 || towards == 0.0) return n;
  vec3 facing = across / (towards < 0.0 ? -size : size);
  vec3 mirrored = reflect(-v, n);
  float least = min(SHARE_MIRRORED * abs(towards) / size, LEAST_MIRRORED), above = dot(mirrored, facing);
  if (above >= least) return n;
  return normalize(v + normalize(mirrored + (least - above) * facing));
}

#endif
