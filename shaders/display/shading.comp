#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ShadePush push; };
#include "display/pixel.glsl"
#define SCENE push.scene.at[0]
#include "display/spot.glsl"

// What light leaves the surface at a display vertex, W/mm^2.
struct Left {
  vec3 exitance, unscattered;
};

Left left_at(uint vertex) {
  uvec3 corners = SCENE.faces.at[SCENE.face.at[vertex]];
  vec3 l = SCENE.barycentric.at[vertex];
  return Left(weighed(l, SCENE.exitance.at[corners.x], SCENE.exitance.at[corners.y], SCENE.exitance.at[corners.z]),
              weighed(l, SCENE.unscattered.at[corners.x], SCENE.unscattered.at[corners.y],
                      SCENE.unscattered.at[corners.z]));
}

// Lambertian exitance behind a smooth surface: radiance depends on direction by Fresnel's transmittance alone.
void main() {
  Pixel pixel;
  if (!find_pixel(pixel)) return;
  SeenPixel seen = seen_in(pixel);
  vec3 layers[PICTURE_LAYERS];
  for (uint k = 0u; k < PICTURE_LAYERS; ++k) layers[k] = vec3(0);
  uint waiting = covered_samples(seen.samples);
  while (waiting != 0u) {
    uint k = uint(findLSB(waiting)), samples = alike(seen.samples, k);
    waiting &= ~samples;
    Spot spot = spot_of(pixel, seen.samples[k] - 1u, samples);
    Left a = left_at(spot.vertices.x), b = left_at(spot.vertices.y), c = left_at(spot.vertices.z);
    spot.share *= seen.scale;
    float radiance = spot.share * spot.even_transmittance;
    layers[0] += radiance * weighed(spot.l, a.exitance, b.exitance, c.exitance);
    layers[1] += spot.share * spot.specular;
    layers[2] += radiance * weighed(spot.l, a.unscattered, b.unscattered, c.unscattered);
  }
  write_pixel(pixel, layers, seen.alpha);
}
