// Sweeps over the block of path_relax.comp.
#ifndef QUADGRAPH_PATH_SWEEP_GLSL
#define QUADGRAPH_PATH_SWEEP_GLSL

#include "path/path_block.glsl"
#include "path/path_update.h"

// Nine cells of a plane, row after row.
struct Plane {
  vec3 rows[3];
};

float least_of(Plane t) {
  vec3 least = min(t.rows[0], min(t.rows[1], t.rows[2]));
  return min(least.x, min(least.y, least.z));
}

// The least of the rests (path_update.h) of paths through a corner: from the middle cell of a side, over its two
// neighbours beside the corner, or from these. Lengths over the cost of a cell's side.
void through_corner(float middle, float first, float second, float corner, inout float rest, inout float first_rest,
                    inout float second_rest) {
  float to_first = middle - first, first_on = first - corner, to_second = middle - second, second_on = second - corner;
  rest = min(rest, min(edge_rest(middle - corner, 1.0, 2.0), edge_rest(to_first, 1.0, 1.0)));
  rest = min(rest, min(triangle_rest(to_first, first_on), triangle_rest(to_second, second_on)));
  first_rest = min(first_rest, edge_rest(first_on, 2.0, 1.0));
  second_rest = min(second_rest, edge_rest(second_on, 2.0, 1.0));
}

float through_side(Plane t, float cost) {
  // Falls are what matters, and lengths may be large beside them.
  float least = least_of(t), inverse = 1.0 / cost;
  vec3 low = (t.rows[0] - least) * inverse, mid = (t.rows[1] - least) * inverse, high = (t.rows[2] - least) * inverse;
  float rest = 1.0;
  // Rests of the four beside the middle, each the first of one corner.
  float left = 1.0, below = 1.0, right = 1.0, above = 1.0;
  through_corner(mid.y, mid.x, low.y, low.x, rest, left, below);
  through_corner(mid.y, low.y, mid.z, low.z, rest, below, right);
  through_corner(mid.y, mid.z, high.y, high.z, rest, right, above);
  through_corner(mid.y, high.y, mid.x, high.x, rest, above, left);
  vec4 middles = vec4(t.rows[1].x, t.rows[0].y, t.rows[1].z, t.rows[2].y);
  vec4 beside = middles + sqrt(2.0) * cost * sqrt(vec4(left, below, right, above));
  vec4 corners = vec4(t.rows[0].xz, t.rows[2].xz) + sqrt(3.0) * cost;
  vec4 best = min(beside, corners);
  return min(t.rows[1].y + cost * sqrt(rest), min(min(best.x, best.y), min(best.z, best.w)));
}

// Least path by a step of the lattice, whose cost is its length times the mean of both ends. Other paths cost what the
// cell does that they lead to, so that all points of a side are weighed alike, and no order of updates matters.
float by_steps(Plane t, Plane costs, float cost) {
  vec3 way0 = sqrt(vec3(3, 2, 3)), way1 = sqrt(vec3(2, 1, 2));
  vec3 found = t.rows[0] + way0 * (0.5 * (cost + costs.rows[0]));
  found = min(found, t.rows[1] + way1 * (0.5 * (cost + costs.rows[1])));
  found = min(found, t.rows[2] + way0 * (0.5 * (cost + costs.rows[2])));
  return min(found.x, min(found.y, found.z));
}

// No path that leads through a neighbour is shorter than this: paths that leave between neighbours cost at least
// sqrt(1/3) more than any of them, others more.
float at_least(float neighbour, float cost) {
  return neighbour + 0.5 * cost;
}

vec3 length_row(int middle, int u) {
  return vec3(lengths[middle - u], lengths[middle], lengths[middle + u]);
}

vec3 cost_row(int middle, int u) {
  return vec3(costs[middle - u], costs[middle], costs[middle + u]);
}

// The bits of `mask` and those beside them, in the block.
uint widened(uint mask) {
  return (mask | mask << 1u | mask >> 1u) & OWN_BITS;
}

// Bits of a mask like `dirty` along an axis.
uint bits_along(uint mask, uint axis) {
  return mask >> uint(WIDE) * axis & ((1u << WIDE) - 1u);
}

// The planes along a way that follow one of those bits, the first of the way as bit 0.
uint planes_after(uint mask, uint way) {
  uint along = bits_along(mask, way % 3u);
  return way < 3u ? along & 255u : bitfieldReverse(along) >> 22u & 255u;
}

// Relaxes cells of a plane, rows of them along v, from the plane before, `forward` back; what has fallen.
uint relax_rows(int cell, int forward, int u, int v, int count) {
  Plane t, c;
  t.rows[1] = length_row(cell - forward - v, u);
  t.rows[2] = length_row(cell - forward, u);
  if (LATTICE == 1u) c.rows[1] = cost_row(cell - forward - v, u);
  if (LATTICE == 1u) c.rows[2] = cost_row(cell - forward, u);
  uint falls = 0u;
  for (int row = 0; row < count; ++row) {
    t.rows[0] = t.rows[1];
    t.rows[1] = t.rows[2];
    t.rows[2] = length_row(cell - forward + v, u);
    if (LATTICE == 1u) {
      c.rows[0] = c.rows[1];
      c.rows[1] = c.rows[2];
      c.rows[2] = cost_row(cell - forward + v, u);
    }
    float cost = costs[cell], old = lengths[cell];
    if (cost >= 0.0 && at_least(least_of(t), cost) < old) {
      float found = LATTICE == 1u ? by_steps(t, c, cost) : through_side(t, max(cost, 1e-30));
      if (found < old) {
        lengths[cell] = found;
        falls |= 1u << row;
      }
    }
    cell += v;
  }
  return falls;
}

// One plane after the other along an axis, each from the one before where that has changed: since `mask`, or by this
// sweep. An invocation takes cells that follow each other along v, and keeps what the next one needs again. Returns
// where lengths have fallen, as `dirty`.
uint sweep(uint way, uint mask) {
  uint axis = way % 3u, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  if (bitCount(bits_along(mask, u)) < bitCount(bits_along(mask, v))) {
    uint other = u;
    u = v;
    v = other;
  }
  int forward = way < 3u ? STRIDES[axis] : -STRIDES[axis], lane = int(gl_LocalInvocationID.x);
  // A plane is shared out by columns, and by rows where there are more invocations than columns.
  int parts = max(int(gl_WorkGroupSize.x), PATH_BLOCK), most_rows = PATH_BLOCK * PATH_BLOCK / parts;
  uint changed_rows = widened(bits_along(mask, v)), changed_planes = planes_after(mask, way);
  uint planes = changed_planes, rows_before = 0u, all = 0u;
  int slot = 0;
  while (planes != 0u) {
    int k = findLSB(planes);
    planes &= planes - 1u;
    uint rows = ((changed_planes & 1u << k) != 0u ? changed_rows : 0u) | rows_before;
    int plane = way < 3u ? 1 + k : PATH_BLOCK - k, next = (slot + 1) % 3;
    if (lane == 0) fallen[next] = 0u;
    for (int part = lane; part < parts; part += int(gl_WorkGroupSize.x)) {
      int across = part % PATH_BLOCK + 1, own = part / PATH_BLOCK * most_rows + 1;
      int first = max(findLSB(rows), own), end = min(findMSB(rows) + 1, own + most_rows);
      int cell = plane * STRIDES[axis] + across * STRIDES[u] + first * STRIDES[v];
      uint falls = relax_rows(cell, forward, STRIDES[u], STRIDES[v], end - first) << first;
      if (falls != 0u) atomicOr(fallen[slot], falls | 1u << (WIDE + across));
    }
    barrier();
    uint fell = fallen[slot];
    slot = next;
    rows_before = widened(fell & OWN_BITS);
    if (fell == 0u) continue;
    all |= 1u << (uint(WIDE) * axis + uint(plane)) | (fell & OWN_BITS) << uint(WIDE) * v |
           (fell >> uint(WIDE)) << uint(WIDE) * u;
    if (k + 1 < PATH_BLOCK) planes |= 1u << (k + 1);
  }
  return all;
}

// Sweeps up and down the axes as long as something may fall; where it has, as `dirty`. Gives up after MOST_SWEEPS.
uint relax() {
  uint way = 5u, all = 0u;
  for (uint k = 0u; k < MOST_SWEEPS; ++k) {
    uint ways = 0u;
    for (uint other = 0u; other < 6u; ++other) ways |= planes_after(dirty[other], other) != 0u ? 1u << other : 0u;
    if (ways == 0u) return all;
    do way = (way + 1u) % 6u;
    while ((ways & 1u << way) == 0u);
    if (gl_LocalInvocationID.x == 0u) fallen[0] = 0u;
    uint mask = dirty[way];
    barrier();
    uint found = sweep(way, mask);
    all |= found;
    for (uint other = gl_LocalInvocationID.x; other < 6u; other += gl_WorkGroupSize.x) {
      dirty[other] = other == way ? 0u : dirty[other] | found;
    }
    barrier();
  }
  if (gl_LocalInvocationID.x == 0u) changed_blocks = 1u << PATH_SELF;
  return all;
}

#endif
