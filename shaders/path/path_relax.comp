#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_block.glsl"

// A block of one channel per workgroup. What it sees of its neighbours are the lengths before this round, as a block
// leaves those alone and writes its own beside them: which workgroup is quicker changes no bit, where an update through
// a side may round up what a shorter path rounds down. A block is relaxed again in a round after a neighbour's side has
// changed so that it may matter.
layout(local_size_x = PATH_GROUP) in;
#include "path/path_sweep.glsl"

// The copy of a block's lengths that held before this round.
uint copy_of(uint item) {
  uint last = push.copies.at[item];
  return last / 2u == push.round + 1u ? 1u - last % 2u : last % 2u;
}

// Cells of both copies lie so far apart.
uint copy_offset(uint copy, uint channel) {
  return (3u * copy + channel) * cell_count(push.grid);
}

// Number, as that of one of 27, of the block that a cell of the wide one lies in.
uint block_around(ivec3 local) {
  ivec3 way = (local + PATH_BLOCK) / PATH_BLOCK;
  return uint(way.x + 3 * (way.y + 3 * way.z));
}

void load_cells(ivec3 first, uint channel) {
  uint offset = channel * cell_count(push.grid);
  for (uint k = gl_LocalInvocationID.x; k < WIDE_CELLS; k += gl_WorkGroupSize.x) {
    ivec3 local = ivec3(k % WIDE, k / WIDE % WIDE, k / (WIDE * WIDE)) - 1;
    ivec3 cell = first + local;
    bool there = all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, ivec3(push.grid.size)));
    uint number = there ? cell_number(push.grid, uvec3(cell)) : 0u;
    costs[k] = there ? push.grid.cell * push.cost.at[offset + number] : -1.0;
    lengths[k] = there ? push.paths.at[copy_offset(copies[block_around(local)], channel) + number] : PATH_FAR;
    bool own = all(greaterThanEqual(local, ivec3(0))) && all(lessThan(local, ivec3(PATH_BLOCK)));
    if (own) before[own_number(local)] = lengths[k];
  }
}

void store_block(ivec3 first, uint item, uint channel) {
  uint copy = 1u - copies[PATH_SELF], offset = copy_offset(copy, channel);
  if (gl_LocalInvocationID.x == 0u) push.copies.at[item] = 2u * (push.round + 1u) + copy;
  for (uint k = gl_LocalInvocationID.x; k < CELLS; k += gl_WorkGroupSize.x) {
    ivec3 cell = own_cell(k);
    float now = lengths[at(cell)];
    bool fallen = now < before[k];
    before[k] = fallen ? now : PATH_FAR;
    push.paths.at[offset + cell_number(push.grid, uvec3(first + cell))] = now;
  }
}

// A number that is larger for a larger x.
uint sortable(float x) {
  uint bits = floatBitsToUint(x);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

uint item_of(ivec3 block, ivec3 blocks, uint channel) {
  return uint(block.x + blocks.x * (block.y + blocks.y * (block.z + blocks.z * int(channel))));
}

ivec3 way_to(uint number) {
  return ivec3(number % 3u, number / 3u % 3u, number / 9u) - 1;
}

// Whether what has fallen may shorten paths to the cells of a block around that are beside it; and from where on.
void look_at(uint number) {
  ivec3 way = way_to(number);
  bvec3 beyond = notEqual(way, ivec3(0));
  ivec3 wide = mix(ivec3(PATH_BLOCK), ivec3(1), beyond);
  uint across = beyond.x ? 0u : beyond.y ? 1u : 2u, count = uint(wide.x * wide.y * wide.z);
  for (uint k = gl_LocalInvocationID.x; k < count; k += gl_WorkGroupSize.x) {
    ivec3 place = ivec3(k % wide.x, k / wide.x % wide.y, k / (wide.x * wide.y));
    ivec3 cell = mix(place, mix(ivec3(-1), ivec3(PATH_BLOCK), equal(way, ivec3(1))), beyond);
    float least = PATH_FAR;
    for (int n = 0; n < 9; ++n) {
      ivec3 other = cell;
      other[(across + 1u) % 3u] += n % 3 - 1;
      other[(across + 2u) % 3u] += n / 3 - 1;
      least = min(least, before[own_number(clamp(other, ivec3(0), ivec3(PATH_BLOCK - 1)))]);
    }
    float cost = costs[at(cell)];
    if (cost < 0.0 || at_least(least, cost) >= lengths[at(cell)]) continue;
    atomicOr(changed_blocks, 1u << number);
    atomicMin(arrivals[number], sortable(least));
    atomicMin(crossings[number], sortable(least + float(PATH_BLOCK) * cost));
  }
}

// Puts a block into the next round's list, if it has solid cells: changed at those of the 27 blocks around, from that
// length on, and crossed at that one.
void list(uint item, uint all, uint from, uint arrival, uint crossing) {
  uint next = push.round + 1u, there = next % 2u * 3u * all + item;
  if ((push.wanted.at[there] & PATH_NEVER) != 0u) return;
  atomicMin(push.arrivals.at[there].x, arrival);
  atomicMin(push.arrivals.at[there].y, crossing);
  atomicMin(push.fronts.at[3u * next + item / all], crossing);
  if (atomicOr(push.wanted.at[there], from) == 0u) push.next.at[atomicAdd(push.groups.at[3u * next], 1u)] = item;
}

void list_blocks(ivec3 block, ivec3 blocks, uint channel, uint moved) {
  // Bits of those of the 27 blocks that something has fallen beside.
  uint near = 0u;
  for (uint k = 0u; k < 27u; ++k) {
    bool all = k != PATH_SELF && moved != 0u;
    for (uint axis = 0u; axis < 3u; ++axis) {
      int way = way_to(k)[axis];
      all = all && (way == 0 || (bits_along(moved, axis) & (way < 0 ? 2u : 1u << PATH_BLOCK)) != 0u);
    }
    if (all) near |= 1u << k;
  }
  for (uint rest = near; rest != 0u; rest &= rest - 1u) look_at(uint(findLSB(rest)));
  barrier();
  uint all = uint(blocks.x * blocks.y * blocks.z);
  for (uint k = gl_LocalInvocationID.x; k < 27u; k += gl_WorkGroupSize.x) {
    ivec3 other = block + way_to(k);
    if ((changed_blocks & 1u << k) == 0u || any(lessThan(other, ivec3(0))) || any(greaterThanEqual(other, blocks)))
      continue;
    uint item = item_of(other, blocks, channel);
    // From there this one lies the other way.
    list(item, all, 1u << (26u - k), arrivals[k], crossings[k]);
  }
}

// Takes what the block of this workgroup is listed for, and says where it is dirty.
void start(uint here, ivec3 block, ivec3 blocks, uint channel) {
  if (gl_LocalInvocationID.x == 0u) {
    wanted = push.wanted.at[here];
    arrived = push.arrivals.at[here].x;
    crossed = push.arrivals.at[here].y;
    push.wanted.at[here] = 0u;
    push.arrivals.at[here] = uvec2(NONE);
    changed_blocks = 0u;
  }
  for (uint k = gl_LocalInvocationID.x; k < 27u; k += gl_WorkGroupSize.x) {
    arrivals[k] = crossings[k] = NONE;
    ivec3 other = block + way_to(k);
    bool there = all(greaterThanEqual(other, ivec3(0))) && all(lessThan(other, blocks));
    copies[k] = there ? copy_of(item_of(other, blocks, channel)) : 0u;
  }
  barrier();
  uint mask = 0u;
  for (uint k = 0u; k < 27u; ++k) {
    ivec3 way = way_to(k);
    for (uint axis = 0u; axis < 3u; ++axis) {
      uint bits = way[axis] == 0 ? OWN_BITS : way[axis] < 0 ? 1u : 1u << (PATH_BLOCK + 1);
      if ((wanted & 1u << k) != 0u) mask |= bits << uint(WIDE) * axis;
    }
  }
  for (uint way = gl_LocalInvocationID.x; way < 6u; way += gl_WorkGroupSize.x) dirty[way] = mask;
  if (gl_LocalInvocationID.x == 0u) {
    arrivals[PATH_SELF] = arrived;
    crossings[PATH_SELF] = crossed;
  }
}

void main() {
  ivec3 blocks = ivec3(push.grid.size / PATH_BLOCK);
  uint all = uint(blocks.x * blocks.y * blocks.z), item = push.list.at[gl_WorkGroupID.x];
  uint channel = item / all;
  int number = int(item % all);
  ivec3 block = ivec3(number % blocks.x, number / blocks.x % blocks.y, number / (blocks.x * blocks.y));
  ivec3 first = PATH_BLOCK * block;
  start(push.round % 2u * 3u * all + item, block, blocks, channel);
  if (arrived > push.fronts.at[3u * push.round + channel]) {
    if (gl_LocalInvocationID.x == 0u) list(item, all, wanted, arrived, crossed);
    return;
  }
  load_cells(first, channel);
  barrier();
  uint moved = relax();
  store_block(first, item, channel);
  barrier();
  list_blocks(block, blocks, channel, moved);
}
