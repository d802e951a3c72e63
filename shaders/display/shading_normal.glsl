// The normal that the surface is shaded by. The shader that includes it includes display/specular.glsl first.
#ifndef QUADGRAPH_SHADING_NORMAL_GLSL
#define QUADGRAPH_SHADING_NORMAL_GLSL

// Cosines with the surface that what is mirrored keeps, and that the surface itself must have for it.
const float LEAST_MIRRORED = 0.01, SHARE_MIRRORED = 0.9;

// Slopes at a place in the picture, a pixel of which has so many texels a side, times the strength; `roughness` becomes
// what it is with all that is within the pixel: the variance of slopes adds to half the square of alpha [Olano 2010].
vec2 slopes_at(vec2 place, float texels) {
  NormalMapRef map = SCENE.normal_map;
  float level = log2(max(texels, 1.0)), finer = exp2(floor(level));
  bool repeated = map.by_mesh != 0u;
  vec3 texel = mix(load_image(map.texels, tap_of(map.image, place, finer, repeated)),
                   load_image(map.texels, tap_of(map.image, place, 2.0 * finer, repeated)), level - floor(level));
  float spread = max(texel.z - texel.x * texel.x - texel.y * texel.y, 0.0);
  roughness = min(sqrt(roughness * roughness + map.strength * map.strength * spread), 1.0);
  return map.strength * vec2(texel.x, texel.y);
}

// Normal n leaned by a picture at coordinates of the mesh: along what they grow by, and to the picture's top, square to
// that (glTF 2.0, 3.9.3 without tangents).
vec3 textured_normal(vec3 n, vec3 place, vec3 place_right, vec3 place_below, vec3 to_right, vec3 to_below) {
  NormalMapRef map = SCENE.normal_map;
  float area = place_right.x * place_below.y - place_below.x * place_right.y;
  vec3 along = place_below.y * to_right - place_right.y * to_below;
  vec3 down = place_right.x * to_below - place_below.x * to_right;
  along = (area < 0.0 ? -1.0 : 1.0) * (along - dot(along, n) * n);
  float size = length(along);
  if (place.z < 0.5 || area == 0.0 || size == 0.0) return n;
  vec2 texels = vec2(map.image.columns, map.image.rows);
  vec2 right = texels * vec2(place_right.x, place_right.y), below = texels * vec2(place_below.x, place_below.y);
  vec2 slopes = slopes_at(vec2(place.x, place.y), max(length(right), length(below)));
  vec3 top = cross(n, along);
  if (area * dot(top, down) > 0.0) top = -top;
  return normalize(n + (slopes.x * along + slopes.y * top) / size);
}

// Normal n leaned as the map says at `shape`, of NormalMapRef's `rest`; how that and the place in the scene, mm, differ
// from pixel to pixel. What is finer makes `roughness` more; `mesh_normal` becomes n.
//
// The slopes of a picture in a box are of a height along the normal: with the gradients of the picture's coordinates on the surface
// (Mikkelsen 2010) the same is right on any side of the body, and where that is deformed.
vec3 mapped_normal(vec3 n, vec3 shape, vec3 shape_right, vec3 shape_below, vec3 to_right, vec3 to_below) {
  NormalMapRef map = SCENE.normal_map;
  mesh_normal = n;
  if (map.by_mesh != 0u) return textured_normal(n, shape, shape_right, shape_below, to_right, to_below);
  vec3 place = in_box(map.box, shape);
  if (any(greaterThan(abs(place), map.box.half_size))) return n;
  vec3 along = cross(to_below, n), across = cross(n, to_right);
  float area = dot(to_right, along);
  if (area == 0.0) return n;
  float width = max(across_box(map.box, shape_right), across_box(map.box, shape_below));
  vec2 slopes = slopes_at(in_picture(map.box, place), texels_across(map.box, map.image, width));
  vec3 u = dot(map.box.right, shape_right) * along + dot(map.box.right, shape_below) * across;
  vec3 v = dot(map.box.up, shape_right) * along + dot(map.box.up, shape_below) * across;
  return normalize(n + (slopes.x * u + slopes.y * v) / area);
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
