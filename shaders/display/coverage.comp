#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What a display triangle covers of the marked pixels of a tile, at COVERAGE_PLACES each. Nothing is hidden there: what
// covers a place counts, whatever else does.
struct CoveragePush {
  SurfaceScenes scene;  // one
  Vec4s places;         // pixels, from the middle of each: four to the right, and as many down
  Uints marked;         // as silhouette.comp left it
  PixelCoverages coverage;  // per pixel of the tile, added to
  uint triangles;
  TilePixels tile;
  uint first_row;  // of the tile: those that are covered
  uint row_count;
  float reach;  // pixels: no place is farther from the middle along an axis
};
layout(push_constant, scalar) uniform Block { CoveragePush push; };
#define SCENE push.scene.at[0]

vec4 clip_of(uint corner) {
  vec3 vertex = SCENE.vertices.at[SCENE.triangles.at[3u * gl_GlobalInvocationID.x + corner]];
  return SCENE.clip_from_offset * vec4(vertex - SCENE.origin, 1.0);
}

// Pixels of the tile that a triangle may reach: first and last column and row, empty where a last one is less.
ivec4 pixels_near(vec4 a, vec4 b, vec4 c) {
  ivec2 size = ivec2(push.tile.width, push.tile.height);
  if (min(a.w, min(b.w, c.w)) <= 0.0) return ivec4(0, 0, size.x - 1, size.y - 1);  // reaches behind the eye
  vec2 p = a.xy / a.w, q = b.xy / b.w, r = c.xy / c.w;
  vec2 low = min(p, min(q, r)), high = max(p, max(q, r));
  vec2 across = 0.5 * vec2(push.tile.picture_width, push.tile.picture_height), tile = vec2(push.tile.left, push.tile.top);
  vec2 first = across * vec2(1.0 + low.x, 1.0 - high.y) - tile - 0.5 - push.reach;
  vec2 last = across * vec2(1.0 + high.x, 1.0 - low.y) - tile - 0.5 + push.reach;
  ivec2 from = ivec2(clamp(ceil(first), vec2(0), vec2(size))), to = ivec2(clamp(floor(last), vec2(-1), vec2(size - 1)));
  return ivec4(from.x, from.y, to.x, to.y);
}

// Twice the area between two corners and a place, in homogeneous coordinates [Olano 1997]: at the middle of a
// pixel, and how it grows to the right and down, per pixel.
vec3 edge_of(vec4 a, vec4 b, vec2 middle) {
  vec2 p = a.xy - a.w * middle, q = b.xy - b.w * middle;
  vec2 pixel = 2.0 / vec2(push.tile.picture_width, push.tile.picture_height);
  return vec3(p.x * q.y - p.y * q.x, pixel.x * (b.w * a.y - a.w * b.y), pixel.y * (b.w * a.x - a.w * b.x));
}

// Least and most of it at any place of a pixel.
vec2 range_of(vec3 line) {
  float spread = push.reach * (abs(line.y) + abs(line.z));
  return vec2(line.x - spread, line.x + spread);
}

// Bits: which of four places lie inside all lines.
uint covered_of_four(vec3 lines[5], uint four) {
  vec4 x = push.places.at[2u * four], y = push.places.at[2u * four + 1u], inside = vec4(1);
  for (uint k = 0u; k < 5u; ++k) inside = min(inside, lines[k].x + lines[k].y * x + lines[k].z * y);
  return (inside.x >= 0.0 ? 1u : 0u) | (inside.y >= 0.0 ? 2u : 0u) | (inside.z >= 0.0 ? 4u : 0u) |
         (inside.w >= 0.0 ? 8u : 0u);
}

// Of the places of a word. Not by a loop: lavapipe ends all loops of an invocation after 65535 rounds together.
uint covered_places(vec3 lines[5], uint word) {
  uint first = covered_of_four(lines, 8u * word) | covered_of_four(lines, 8u * word + 1u) << 4u |
               covered_of_four(lines, 8u * word + 2u) << 8u | covered_of_four(lines, 8u * word + 3u) << 12u;
  uint second = covered_of_four(lines, 8u * word + 4u) | covered_of_four(lines, 8u * word + 5u) << 4u |
                covered_of_four(lines, 8u * word + 6u) << 8u | covered_of_four(lines, 8u * word + 7u) << 12u;
  return first | second << 16u;
}

void cover(uint pixel, uint triangle, vec2 middle, vec4 a, vec4 b, vec4 c) {
  vec3 lines[5];
  lines[0] = edge_of(b, c, middle);
  lines[1] = edge_of(c, a, middle);
  lines[2] = edge_of(a, b, middle);
  // Not before the near plane nor behind the far one.
  lines[3] = a.z * lines[0] + b.z * lines[1] + c.z * lines[2];
  lines[4] = a.w * lines[0] + b.w * lines[1] + c.w * lines[2] - lines[3];
  float least = 0.0;
  uint any = 0u;
  for (uint k = 0u; k < 5u; ++k) {
    vec2 range = range_of(lines[k]);
    if (range.y < 0.0) return;
    least = min(least, range.x);
  }
  for (uint word = 0u; word < COVERAGE_WORDS; ++word) {
    uint covered = least < 0.0 ? covered_places(lines, word) : ~0u;
    if (covered != 0u) atomicOr(push.coverage.at[pixel].covered[word], covered);
    any |= covered;
  }
  if (any != 0u) atomicMax(push.coverage.at[pixel].triangle, 1u + triangle);
}

void main() {
  uint triangle = gl_GlobalInvocationID.x;
  if (triangle >= push.triangles) return;
  vec4 a = clip_of(0u), b = clip_of(1u), c = clip_of(2u);
  float facing = dot(vec3(a.x, a.y, a.w), cross(vec3(b.x, b.y, b.w), vec3(c.x, c.y, c.w)));
  if (!(facing > 0.0)) return;  // turned away, nothing, or not a number
  ivec4 near = pixels_near(a, b, c);
  near.y = max(near.y, int(push.first_row));
  near.w = min(near.w, int(push.first_row + push.row_count) - 1);
  uint words = silhouette_words(push.tile.width);
  for (int y = near.y; y <= near.w; ++y) {
    for (int word = near.x / 32; 32 * word <= near.z; ++word) {
      uint marked = push.marked.at[uint(y) * words + uint(word)];
      if (32 * word < near.x) marked &= ~0u << uint(near.x - 32 * word);
      if (32 * word + 31 > near.z) marked &= ~0u >> uint(32 * word + 31 - near.z);
      while (marked != 0u) {
        uint x = 32u * uint(word) + uint(findLSB(marked));
        marked &= marked - 1u;
        vec2 at = vec2(push.tile.left + x, push.tile.top + uint(y)) + 0.5;
        vec2 middle = 2.0 * at / vec2(push.tile.picture_width, push.tile.picture_height) - 1.0;
        cover(uint(y) * push.tile.width + x, triangle, vec2(middle.x, -middle.y), a, b, c);
      }
    }
  }
}
