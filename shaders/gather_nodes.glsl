// What a face adds to the nodes of its tree. Include after a push with gathered and exitance, and a SolidRef `solid`.

GatherNode node_of_face(uint face) {
  GatherNode node = GatherNode(vec3(0), vec3(0), vec3(0), vec3(0), 0.0);
  if (load_uint(solid.body.face_kinds, face) != FACE_OPEN) return node;
  uvec3 ids = load_uvec3(solid.body.faces, face);
  vec3 a = load_vec3(solid.body.vertices, ids.x), b = load_vec3(solid.body.vertices, ids.y),
       c = load_vec3(solid.body.vertices, ids.z);
  node.normal = 0.5 * cross(b - a, c - a);
  node.area = length(node.normal);
  node.place = node.area * (a + b + c) / 3.0;
  node.gathered = node.area * load_vec3(push.gathered, face);
  for (int k = 0; k < 3; ++k) node.exitance += node.area / 3.0 * load_vec3(push.exitance, ids[k]);
  return node;
}

GatherNode sum_of(GatherNode a, GatherNode b) {
  return GatherNode(a.exitance + b.exitance, a.gathered + b.gathered, a.normal + b.normal, a.place + b.place,
                    a.area + b.area);
}
