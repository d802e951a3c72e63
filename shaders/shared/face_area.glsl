// mm^2; include after push constants that have vertices and faces.
float area_of(uint face) {
  uvec3 corners = load_uvec3(push.faces, face);
  vec3 p = load_vec3(push.vertices, corners.x);
  return 0.5 * length(cross(load_vec3(push.vertices, corners.y) - p, load_vec3(push.vertices, corners.z) - p));
}
