#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "path_shared.h"
#include "path_update.h"

// A block of one channel per workgroup. Lengths only fall, and whatever mixture of old and new ones a workgroup sees of
// its neighbours, each is the length of a path; a block is relaxed again in the round after a neighbour's side has
// changed. What is left when no block is listed is the one solution, whatever the order.
layout(local_size_x = PATH_GROUP) in;
layout(push_constant, scalar) uniform Block { PathRelaxPush push; };
// 1: paths go from middle to middle; 0: from any point between.
layout(constant_id = 1) const uint LATTICE = 0u;

const int WIDE = PATH_BLOCK + 2;  // with a cell of the neighbours on either side
const int ROUNDS = 6;             // of sweeps at a time
const uint SELF = 13u;            // of 27 blocks

shared float lengths[WIDE * WIDE * WIDE];
shared float costs[WIDE * WIDE * WIDE];  // of a cell's side
shared float before[PATH_BLOCK * PATH_BLOCK * PATH_BLOCK];
shared uint falls;
shared uint changed_sides;

int at(ivec3 cell) {
  return (cell.x + 1) + WIDE * ((cell.y + 1) + WIDE * (cell.z + 1));
}

void load_block(ivec3 first, uint channel) {
  uint offset = channel * cell_count(push.grid);
  for (uint k = gl_LocalInvocationID.x; k < WIDE * WIDE * WIDE; k += PATH_GROUP) {
    ivec3 local = ivec3(k % WIDE, k / WIDE % WIDE, k / (WIDE * WIDE)) - 1;
    ivec3 cell = first + local;
    bool there = all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, ivec3(push.grid.size)));
    uint number = there ? offset + cell_number(push.grid, uvec3(cell)) : 0u;
    costs[k] = there ? push.grid.cell * load_float(push.cost, number) : -1.0;
    lengths[k] = there ? load_float(push.paths, number) : PATH_FAR;
    bool own = all(greaterThanEqual(local, ivec3(0))) && all(lessThan(local, ivec3(PATH_BLOCK)));
    if (own) before[local.x + PATH_BLOCK * (local.y + PATH_BLOCK * local.z)] = lengths[k];
  }
}

// Of a step of the lattice, over its length: the mean of both ends. Other paths cost what the cell does that they lead
// to, so that all points of a side are weighed alike, and no order of updates matters.
float step_cost(float cost, int neighbour) {
  return 0.5 * (cost + costs[neighbour]);
}

// The least, and through triangles, of the lengths around the corner t2 of a side of which t0 is the middle one.
float through_corner(float t0, float t1, float other, float t2, float cost) {
  float best = min(from_edge(t0, t2, cost, 1.0, sqrt(2.0)), from_edge(t0, t1, cost, 1.0, 1.0));
  best = min(best, min(from_edge(t1, t2, cost, sqrt(2.0), 1.0), from_edge(other, t2, cost, sqrt(2.0), 1.0)));
  return min(best, min(from_triangle(t0, t1, t2, cost), from_triangle(t0, other, t2, cost)));
}

// Through the nine neighbours of one side, `centre` the middle one; PATH_FAR where none of them is near enough to make
// `old` shorter.
float through_side(int centre, int u, int v, float cost, float old) {
  float t0 = lengths[centre];
  float u0 = lengths[centre - u], u1 = lengths[centre + u], v0 = lengths[centre - v], v1 = lengths[centre + v];
  float t00 = lengths[centre - u - v], t10 = lengths[centre + u - v];
  float t01 = lengths[centre - u + v], t11 = lengths[centre + u + v];
  float sides = min(min(u0, u1), min(v0, v1)), corners = min(min(t00, t10), min(t01, t11));
  if (min(t0, min(sides, corners)) + 0.5 * cost >= old) return PATH_FAR;
  if (LATTICE == 1u) {
    float best = t0 + step_cost(cost, centre);
    best = min(best, u0 + sqrt(2.0) * step_cost(cost, centre - u));
    best = min(best, u1 + sqrt(2.0) * step_cost(cost, centre + u));
    best = min(best, v0 + sqrt(2.0) * step_cost(cost, centre - v));
    best = min(best, v1 + sqrt(2.0) * step_cost(cost, centre + v));
    best = min(best, t00 + sqrt(3.0) * step_cost(cost, centre - u - v));
    best = min(best, t10 + sqrt(3.0) * step_cost(cost, centre + u - v));
    best = min(best, t01 + sqrt(3.0) * step_cost(cost, centre - u + v));
    return min(best, t11 + sqrt(3.0) * step_cost(cost, centre + u + v));
  }
  float best = min(t0 + cost, min(sides + sqrt(2.0) * cost, corners + sqrt(3.0) * cost));
  // Each of the four sides is the first of one corner.
  best = min(best, through_corner(t0, u0, v0, t00, cost));
  best = min(best, through_corner(t0, v0, u1, t10, cost));
  best = min(best, through_corner(t0, v1, u0, t01, cost));
  return min(best, through_corner(t0, u1, v1, t11, cost));
}

// One plane after the other along an axis, each from the one before.
void sweep(int axis, int direction, ivec2 place) {
  int along = axis == 0 ? 1 : axis == 1 ? WIDE : WIDE * WIDE;
  int u = axis == 0 ? WIDE : axis == 1 ? WIDE * WIDE : 1;
  int v = axis == 0 ? WIDE * WIDE : axis == 1 ? 1 : WIDE;
  [[dont_unroll]] for (int k = 0; k < PATH_BLOCK; ++k) {
    int step = direction > 0 ? k : PATH_BLOCK - 1 - k;
    int cell = (step + 1) * along + (place.x + 1) * u + (place.y + 1) * v;
    float cost = costs[cell], old = lengths[cell];
    if (cost >= 0.0) {
      float found = through_side(cell - direction * along, u, v, max(cost, 1e-30), old);
      if (found < old) {
        lengths[cell] = found;
        falls = 1u;
      }
    }
    barrier();
  }
}

// Bits of the other blocks that a cell is beside: of 3 x 3 x 3, this one in their middle.
uint sides_of(ivec3 cell) {
  uint x = 2u | (cell.x == 0 ? 1u : 0u) | (cell.x == PATH_BLOCK - 1 ? 4u : 0u);
  uint xy = x * (8u | (cell.y == 0 ? 1u : 0u) | (cell.y == PATH_BLOCK - 1 ? 64u : 0u));
  uint xyz = xy * (512u | (cell.z == 0 ? 1u : 0u) | (cell.z == PATH_BLOCK - 1 ? 262144u : 0u));
  return xyz & ~(1u << SELF);
}

void store_block(ivec3 first, uint channel, ivec2 place) {
  uint offset = channel * cell_count(push.grid), bits = 0u;
  for (int z = 0; z < PATH_BLOCK; ++z) {
    ivec3 cell = ivec3(place, z);
    float now = lengths[at(cell)];
    if (now >= before[cell.x + PATH_BLOCK * (cell.y + PATH_BLOCK * cell.z)]) continue;
    push.paths.at[offset + cell_number(push.grid, uvec3(first + cell))] = now;
    bits |= sides_of(cell);
  }
  atomicOr(changed_sides, bits);
}

// Puts those blocks into the next round's list that are not there yet and have solid cells.
void list_blocks(ivec3 block, ivec3 blocks, uint channel) {
  uint k = gl_LocalInvocationID.x;
  if (k >= 27u || (changed_sides & (1u << k)) == 0u) return;
  ivec3 other = block + ivec3(k % 3u, k / 3u % 3u, k / 9u) - 1;
  if (any(lessThan(other, ivec3(0))) || any(greaterThanEqual(other, blocks))) return;
  uint item = uint(other.x + blocks.x * (other.y + blocks.y * other.z)) + channel * uint(blocks.x * blocks.y * blocks.z);
  uint stamp = push.round + 2u;
  if (atomicMax(push.stamps.at[item], stamp) >= stamp) return;
  push.next.at[atomicAdd(push.groups.at[3u * (push.round + 1u)], 1u)] = item;
}

void main() {
  ivec3 blocks = ivec3(push.grid.size / PATH_BLOCK);
  uint all = uint(blocks.x * blocks.y * blocks.z), item = push.list.at[gl_WorkGroupID.x];
  uint channel = item / all;
  int number = int(item % all);
  ivec3 block = ivec3(number % blocks.x, number / blocks.x % blocks.y, number / (blocks.x * blocks.y));
  ivec3 first = PATH_BLOCK * block;
  ivec2 place = ivec2(gl_LocalInvocationID.x % PATH_BLOCK, gl_LocalInvocationID.x / PATH_BLOCK);
  if (gl_LocalInvocationID.x == 0u) changed_sides = 0u;
  load_block(first, channel);
  barrier();
  uint more = 1u;
  [[dont_unroll]] for (int k = 0; k < ROUNDS && more == 1u; ++k) {
    if (gl_LocalInvocationID.x == 0u) falls = 0u;
    barrier();
    [[dont_unroll]] for (int way = 0; way < 6; ++way) sweep(way / 2, way % 2 == 0 ? 1 : -1, place);
    more = falls;
    barrier();
  }
  store_block(first, channel, place);
  if (more == 1u && gl_LocalInvocationID.x == 0u) atomicOr(changed_sides, 1u << SELF);
  barrier();
  list_blocks(block, blocks, channel);
}
