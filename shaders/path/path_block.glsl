// The block of cells that a workgroup of path_relax.comp keeps while it relaxes them, and its push constants.
#ifndef QUADGRAPH_PATH_BLOCK_GLSL
#define QUADGRAPH_PATH_BLOCK_GLSL

#include "path/path_shared.h"

layout(push_constant, scalar) uniform Block { PathRelaxPush push; };
// 1: paths go from middle to middle; 0: from any point between.
layout(constant_id = 1) const uint LATTICE = 0u;

const int WIDE = PATH_BLOCK + 2;  // with a cell of the neighbours on either side
const int WIDE_CELLS = WIDE * WIDE * WIDE, CELLS = PATH_BLOCK * PATH_BLOCK * PATH_BLOCK;
const int STRIDES[3] = {1, WIDE, WIDE * WIDE};
const uint MOST_SWEEPS = 48u;
const uint NONE = 0xffffffffu;
const uint OWN_BITS = 0x1feu;  // of WIDE bits along an axis

shared float lengths[WIDE_CELLS];
shared float costs[WIDE_CELLS];  // of a cell's side
shared float before[CELLS];      // lengths; in the end those that have fallen, of others PATH_FAR
// Where lengths have fallen since the last sweep in each of the ways, 0 to 2 up and 3 to 5 down the axes: bits of x in
// a cube of WIDE, and WIDE higher of y and of z.
shared uint dirty[6];
shared uint fallen[3];  // what a sweep makes fall in a plane, by turns: bits of rows, and WIDE higher across
shared uint wanted, arrived, crossed;  // what this block is listed for
shared uint changed_blocks;
shared uint copies[27];                   // which copies of the lengths of the blocks around hold
shared uint arrivals[27], crossings[27];  // of the blocks around, of numbers that order as the lengths do

int at(ivec3 cell) {
  return (cell.x + 1) + WIDE * ((cell.y + 1) + WIDE * (cell.z + 1));
}

int own_number(ivec3 cell) {
  return cell.x + PATH_BLOCK * (cell.y + PATH_BLOCK * cell.z);
}

ivec3 own_cell(uint number) {
  return ivec3(number % PATH_BLOCK, number / PATH_BLOCK % PATH_BLOCK, number / (PATH_BLOCK * PATH_BLOCK));
}

#endif
