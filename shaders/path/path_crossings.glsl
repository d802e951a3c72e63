// Where the lines through the middles of cells cross a triangle. The shader that includes it defines
//   GRID     the PathGrid, first
//   crossed  what happens at a crossing
#ifndef QUADGRAPH_PATH_CROSSINGS_GLSL
#define QUADGRAPH_PATH_CROSSINGS_GLSL

#include "path/path_shared.h"

#ifndef GRID
#error "path_crossings.glsl: GRID is not defined"
#endif

struct Crossing {
  uint axis;
  uvec3 column;  // of the line; along the axis 0
  float at;      // cells along the axis
  int turn;      // change of the winding number along the axis
};
void crossed(Crossing crossing);

// mm.
vec3 crossing_point(Crossing crossing) {
  vec3 place = vec3(crossing.column) + 0.5;
  place[crossing.axis] = crossing.at;
  return GRID.origin + GRID.cell * place;
}

// Rounded as all passes round them, 1/PATH_SUBCELLS of a cell.
ivec3 rounded(vec3 position) {
  return ivec3(round((position - GRID.origin) * (float(PATH_SUBCELLS) / GRID.cell)));
}

// Twice the area of p, q, s, counter-clockwise above 0; where s lies on the line, as if it lay (e, e^2) further, e > 0
// smaller than all else: so a point on the edge of two triangles is in one of them.
int side_of(ivec2 p, ivec2 q, ivec2 s) {
  ivec2 edge = q - p;
  int doubled = edge.x * (s.y - p.y) - edge.y * (s.x - p.x);
  return doubled != 0 ? doubled : edge.y != 0 ? -edge.y : edge.x;
}

// Every `stripes`-th row of the columns along `axis`, from `stripe` on.
void cross_triangle(ivec3 a, ivec3 b, ivec3 c, uint axis, uint stripe, uint stripes) {
  uint u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  ivec2 p = ivec2(a[u], a[v]), q = ivec2(b[u], b[v]), r = ivec2(c[u], c[v]);
  int doubled = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  if (doubled == 0) return;
  ivec2 last = ivec2(GRID.size[u], GRID.size[v]) - 1;
  ivec2 low = min(p, min(q, r)), high = max(p, max(q, r));
  ivec2 first_cell = clamp((low + PATH_SUBCELLS / 2 - 1) / PATH_SUBCELLS, ivec2(0), last);
  ivec2 last_cell = clamp((high - PATH_SUBCELLS / 2) / PATH_SUBCELLS, ivec2(0), last);
  for (int y = first_cell.y + int(stripe); y <= last_cell.y; y += int(stripes)) {
    for (int x = first_cell.x; x <= last_cell.x; ++x) {
      ivec2 s = PATH_SUBCELLS * ivec2(x, y) + PATH_SUBCELLS / 2;
      ivec3 side = ivec3(side_of(q, r, s), side_of(r, p, s), side_of(p, q, s));
      if (doubled < 0) side = -side;
      if (any(lessThan(side, ivec3(0)))) continue;
      // The weights of a point on an edge are as good as the edge's own rounding; they need not be better. From one
      // corner, so that a face across the axis lies where it is however a device divides.
      vec2 weight = vec2(side.yz) / (float(side.x) + float(side.y) + float(side.z));
      Crossing found;
      found.axis = axis;
      found.column = uvec3(0);
      found.column[u] = uint(x);
      found.column[v] = uint(y);
      vec2 beyond = vec2(b[axis] - a[axis], c[axis] - a[axis]);
      found.at = (float(a[axis]) + dot(weight, beyond)) / float(PATH_SUBCELLS);
      found.turn = doubled > 0 ? -1 : 1;
      crossed(found);
    }
  }
}

#endif
