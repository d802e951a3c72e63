// mm^2; include after push constants that have vertices and faces.
float area_of(uint face) {
  uvec3 corners = push.faces.at[face];
  vec3 p = push.vertices.at[corners.x];
  return 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
}
