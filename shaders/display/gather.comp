#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/shaped.glsl"
#include "material/fresnel.glsl"
#include "light/environment.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ShadePush push; };
#include "display/pixel.glsl"

SurfaceScene scene;
#define SCENE scene
#include "display/spot.glsl"
#define BODY scene.solid.body
#define TREE_BODY scene.solid.body
#define TREE scene.solid.tree
#define NORMALS scene.solid.normals
#define FORWARD_LIGHT scene.solid.forward
#define POINTS scene.points
#include "gather/leaving.glsl"

const float CLEAR_DEPTH = 7.0;  // mean free paths over the whole body

// Barycentric coordinates of the point of a face that lies below or above `point`.
vec3 coordinates_in(uint face, vec3 point) {
  uvec3 ids = BODY.faces.at[face];
  vec3 a = BODY.vertices.at[ids.x];
  vec3 u = BODY.vertices.at[ids.y] - a, v = BODY.vertices.at[ids.z] - a, offset = point - a;
  vec3 normal = cross(u, v);
  float area = max(dot(normal, normal), 1e-30);
  float second = dot(cross(offset, v), normal) / area, third = dot(cross(u, offset), normal) / area;
  return inside_triangle(vec3(1.0 - second - third, second, third));
}

// Radiance of what is behind the body along a ray from the eye, W/(mm^2 sr).
vec3 radiance_behind(vec3 ray) {
  vec3 sum = vec3(0);
  for (uint i = 0u; i < scene.light_count; ++i) {
    LightRecord light = scene.lights.at[i];
    if (light.kind == LIGHT_AMBIENT) sum += light.power / PI;
    if (SHAPED && light.kind == LIGHT_ENVIRONMENT) {
      sum += light.power * environment_at(scene.shapes.at[i], ENVIRONMENT_RAYS, ray);
    }
  }
  return sum;
}

float summed(vec3 radiance) {
  return radiance.x + radiance.y + radiance.z;
}

// Of the point of a face at barycentric coordinates `l`, which that light leaves.
PixelDoubt doubt_at(uint face, vec3 l, Leaving light) {
  vec3 exitance = vec3(0), area = vec3(0);
  for (uint k = 0u; k < 3u; ++k) {
    uint vertex = BODY.faces.at[face][k];
    SurfaceShare share = scene.share.at[vertex];
    exitance += l[k] * scene.exitance.at[vertex];
    area += l[k] / max(share.area.x, 1e-30) * share.area;
  }
  Refraction body = refraction_behind(BODY.face_kinds, face);
  vec3 diffuse = light.through / body.radiance_norm * exitance;
  return PixelDoubt(area.y, area.z, summed(light.radiance - diffuse), 1.0, 0.0);
}

// Whether the body behind a face is clear in some channel: light crosses the most of it in few mean free paths.
bool is_clear(uint face) {
  vec3 sigma = extinction(optical_in(BODY.face_tets.at[face]));
  return min(sigma.x, min(sigma.y, sigma.z)) * scene.reach < CLEAR_DEPTH;
}

// Light that leaves a surface: through more facets where the body is clear, since there they differ, and along a
// silhouette, where a pixel stands out. What a facet shows must not decide, or the mean of all would be another one.
Leaving through_facets(uint face, vec3 l, vec3 v, vec3 normal, Facets facets, float alpha) {
  uint count = is_rough(facets) && is_clear(face) ? push.facets : 1u;
  if (is_rough(facets) && alpha < 1.0) count = max(count, push.edge_facets);
  Leaving sum = Leaving(vec3(0), vec3(0), 0.0);
  for (uint k = 0u; k < count; ++k) {
    Leaving one = leaving(face, l, v, normal, scene.scale, facets, VIEW_PARTS);
    sum.radiance += one.radiance;
    sum.seen += one.seen;
    sum.through += one.through;
    ++facets.number;
  }
  float share = 1.0 / float(count);
  return Leaving(share * sum.radiance, share * sum.seen, share * sum.through);
}

// Whether the pixel is one of those in which two samples of the material are compared, as DOUBT_STRIDE says.
bool is_compared(uint index) {
  uint x = index % push.tile.picture_width, y = index / push.tile.picture_width;
  return x % DOUBT_STRIDE == 0u && y % DOUBT_STRIDE == 0u;
}

// Which sample of the material the block of a pixel is compared with.
uint sample_of_block(uint index) {
  uint x = index % push.tile.picture_width / DOUBT_BLOCK, y = index / push.tile.picture_width / DOUBT_BLOCK;
  return hash(x + (y << 16u)) % DOUBT_SAMPLES;
}

// What samples of a pixel show of one face: one view ray does for it. Between faces what is seen can change too much.
struct Seen {
  uint face;  // outside face of level 0
  float share, roughness;
  float lets_out;  // as of Facets: of coats, whose sides reflect by different facets
  vec3 position, normal;  // mm; unit
  vec3 specular;          // times its share
};

// The face that sample `first` shows; what is taken leaves `waiting`.
Seen face_seen(Pixel pixel, SeenPixel seen, uint first, inout uint waiting) {
  Seen all = Seen(scene.triangle_face.at[seen.samples[first] - 1u], 0.0, 0.0, -1.0, vec3(0), vec3(0), vec3(0));
  for (uint k = first; k < 4u; ++k) {
    if ((waiting >> k & 1u) == 0u || scene.triangle_face.at[seen.samples[k] - 1u] != all.face) continue;
    uint samples = alike(seen.samples, k);
    waiting &= ~samples;
    Spot spot = spot_of(pixel, seen.samples[k] - 1u, samples);
    if (all.share == 0.0) {
      all.roughness = facet_roughness(roughness, surface);
      all.lets_out = surface.coat == 0.0 ? -1.0 : 1.0 - evenly;
    }
    all.share += spot.share;
    all.position += spot.share * spot.position;
    all.normal += spot.share * spot.normal;
    all.specular += spot.share * spot.specular;
  }
  all.position /= all.share;
  all.normal = normalize(all.normal);
  all.share *= seen.scale;
  all.specular *= seen.scale;
  return all;
}

// By the share of a pixel that a face takes.
void add_doubt(inout PixelDoubt doubt, float share, PixelDoubt of_face) {
  doubt.unlit += share * of_face.unlit;
  doubt.dimmest += share * of_face.dimmest;
  doubt.angle += share * of_face.angle;
  doubt.covered += share * of_face.covered;
}

void main() {
  Pixel pixel;
  if (!find_pixel(pixel)) return;
  SeenPixel shown = seen_in(pixel);
  uint waiting = covered_samples(shown.samples);
  if (waiting != 0u) scene = push.scene.at[0];
  bool doubted = uvec2(push.doubt) != uvec2(0);
  vec3 scattered = vec3(0), specular = vec3(0), seen = vec3(0), unscattered = vec3(0);
  PixelDoubt doubt = PixelDoubt(0.0, 0.0, 0.0, 0.0, 0.0);
  uint materials = doubted && uvec2(scene.elsewhere[0]) != uvec2(0) && is_compared(pixel.index) ? 2u : 1u;
  Opticals middle = BODY.optical;
  while (waiting != 0u) {
    uint k_first = uint(findLSB(waiting));
    Seen here = face_seen(pixel, shown, k_first, waiting);
    vec3 v = towards_eye(scene.eye, here.position);
    vec3 l = coordinates_in(here.face, here.position);
    float rough = push.transmission < 0.0 ? here.roughness : push.transmission;
    uint start = hash(4u * pixel.index + k_first);
    Facets facets = Facets(rough, start, push.facets * push.frame, 0u, here.lets_out);
    vec3 elsewhere = vec3(0);
    for (uint material = materials; material-- > 0u;) {
      BODY.optical = material == 0u ? middle : scene.elsewhere[sample_of_block(pixel.index)];
      Leaving light = through_facets(here.face, l, v, here.normal, facets, shown.alpha);
      if (material != 0u) {
        elsewhere = light.radiance;
        continue;
      }
      if (materials == 2u) doubt.medium += here.share * summed(elsewhere - light.radiance);
      scattered += here.share * light.radiance;
      seen += here.share * light.seen;
      unscattered += here.share * light.seen * radiance_behind(-v);
      if (doubted) add_doubt(doubt, here.share, doubt_at(here.face, l, light));
    }
    specular += here.specular;
  }
  vec3 layers[PICTURE_LAYERS];
  layers[0] = scattered;
  layers[1] = specular;
  layers[2] = unscattered;
  layers[3] = seen;
  write_pixel(pixel, layers, shown.alpha);
  if (doubted) push.doubt.at[pixel.index] = doubt;
}
