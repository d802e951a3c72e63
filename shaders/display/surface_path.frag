#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_light_shared.h"

layout(push_constant, scalar) uniform Block { SurfacePathPush push; };
#define SCENE push.scene.at[0]
layout(location = 0) in vec3 position;  // mm
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 rest;  // mm, where the roughness lies
layout(location = 3) in vec3 shape;  // mm, the position at rest
layout(location = 0) out vec4 scattered_coverage;  // W/(mm^2 sr), 1
layout(location = 1) out vec4 specular;            // W/(mm^2 sr), 1
layout(location = 2) out vec4 unscattered;         // none, 1

#include "path/path_field.glsl"
#include "path/path_tools.glsl"
#include "display/specular.glsl"
#include "display/shading_normal.glsl"

// Where a ray from the eye to `end` last leaves a tool: the point, and there the direction out of what is left; false
// where it meets none. From afar it is followed from before the body on.
bool last_cut(PathTools tools, vec3 end, out vec3 point, out vec3 outward) {
  float far = SCENE.eye.w > 0.0 ? distance(SCENE.eye.xyz, end) : SCENE.reach;
  vec3 way = -min(far, SCENE.reach) * towards_eye(SCENE.eye, end), start = end - way;
  float latest = 0.0;
  for (uint k = 0u; k < tools.count; ++k) {
    PathTool tool = tools.at.at[k];
    vec2 span = tool_span(tool, start, way);
    if (span.x >= span.y || span.y <= latest || span.y >= 1.0) continue;
    latest = span.y;
    point = start + latest * way;
    outward = -tool_gradient(tool, point);
  }
  return latest > 0.0;
}

// Open surfaces are seen from both sides. A side that is turned away from the eye is seen through a hole, or because
// what lay before it has been cut away: then the cut face is what is seen, and it lies on the same ray.
void main() {
  roughness = SCENE.roughness;
  surface = SCENE.surface;
  PathField field = push.field.at[0];
  if (field.tools.count > 0u && cut_away(field.tools, position)) discard;
  if (has_roughness_map()) place_roughness(rest, dFdx(rest), dFdy(rest));
  vec3 at = position, n = normalize(normal), to_right = dFdx(position), to_below = dFdy(position);
  if (has_normal_map()) n = mapped_normal(n, shape, dFdx(shape), dFdy(shape), to_right, to_below);
  vec3 across = cross(to_right, to_below);
  if (field.tools.count > 0u && !gl_FrontFacing) {
    vec3 point, outward;
    if (last_cut(field.tools, position, point, outward)) {
      at = point;
      n = mesh_normal = outward;
      across = vec3(0);
    }
  }
  vec3 v = towards_eye(SCENE.eye, at);
  if (dot(n, v) < 0.0 && !gl_FrontFacing) mesh_normal = -mesh_normal;
  if (dot(n, v) < 0.0) n = gl_FrontFacing ? normalize(n - 1.001 * dot(n, v) * v) : -n;
  n = seen_normal(n, across, v);
  float cosine = clamp(dot(n, v), 0.0, 1.0);
  evenly = fresnel_reflectance(cosine, surface);
  coat_evenly = surface.coat * fresnel_reflectance(cosine, surface.coat_eta);
  float share = (1.0 - evenly) / SCENE.radiance_norm;
  scattered_coverage = vec4(share * path_exitance(field, at), 1.0);
  specular = vec4(specular_radiance(at, n, v, 1.0), 1.0);
  unscattered = vec4(0.0, 0.0, 0.0, 1.0);
}
