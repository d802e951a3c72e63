// Which pixels of a tile a triangle covers, and how deep it lies there.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "engine/cpu/triangles.h"

namespace quadgraph::cpu {

// A triangle as a tile draws it: edge k lies across from corner k. Its function is above 0 inside and 0 on it, and
// changes by the steps from pixel to pixel.
struct Drawn {
  const Triangle* triangle;
  std::array<std::int64_t, 3> at;              // at the centre of the tile's first pixel
  std::array<std::int64_t, 3> step_x, step_y;  // per pixel
  double inverse;                              // of the sum of the three
};

// Pixels of a tile, end excluded.
struct Box {
  std::uint32_t x0, y0, x1, y1;
};

// Pixels of a row side by side.
constexpr std::uint32_t lanes = 4;
using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));
using Pair = double __attribute__((vector_size(16)));

// The function of edge k at a pixel, less what is in: 0 of top and left edges, else 1. It is not below 0 inside.
inline std::int64_t edge_at(const Drawn& drawn, std::size_t k, std::uint32_t x, std::uint32_t y) {
  const bool top_left = drawn.step_x[k] > 0 || (drawn.step_x[k] == 0 && drawn.step_y[k] > 0);
  return drawn.at[k] + x * drawn.step_x[k] + y * drawn.step_y[k] - (top_left ? 0 : 1);
}

// An edge function at pixels side by side, where its numbers stay below 2^31.
struct Edge {
  Ints row;   // at the first pixels of the row
  Ints step;  // from pixels to those beside them
  std::int32_t step_y;

  Edge(const Drawn& drawn, std::size_t k, std::uint32_t x, std::uint32_t y)
      : step(static_cast<std::int32_t>(lanes * drawn.step_x[k]) + Ints{}),
        step_y(static_cast<std::int32_t>(drawn.step_y[k])) {
    row = static_cast<std::int32_t>(edge_at(drawn, k, x, y)) +
          static_cast<std::int32_t>(drawn.step_x[k]) * Ints{0, 1, 2, 3};
  }
};

// Depth of a triangle in its plane, at pixels side by side: of the first two and of the others.
struct Plane {
  Pair left, right;  // at the first pixels of the row
  Pair step;         // from pixels to those beside them
  double step_y;

  Plane(const Drawn& drawn, std::uint32_t x, std::uint32_t y) {
    double at = 0, step_x = 0;
    step_y = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double depth = drawn.inverse * double{drawn.triangle->z[k]};
      at += static_cast<double>(drawn.at[k] + x * drawn.step_x[k] + y * drawn.step_y[k]) * depth;
      step_x += static_cast<double>(drawn.step_x[k]) * depth;
      step_y += static_cast<double>(drawn.step_y[k]) * depth;
    }
    left = Pair{at, at + step_x};
    right = left + 2 * step_x;
    step = lanes * step_x + Pair{};
  }
};

inline Floats rounded(Pair left, Pair right) {
  return Floats{static_cast<float>(left[0]), static_cast<float>(left[1]), static_cast<float>(right[0]),
                static_cast<float>(right[1])};
}

// Calls take(pixel of the tile, mask, depth) for pixels side by side, of which the mask says which are in the triangle:
// maybe none, as asking would take longer than taking. For a triangle whose edge functions stay below 2^31 in the box;
// all of the box is looked at.
template <typename Take>
void walk_box(const Drawn& drawn, const Box& box, const Take& take) {
  const std::uint32_t x0 = box.x0 / lanes * lanes;
  Edge a(drawn, 0, x0, box.y0), b(drawn, 1, x0, box.y0), c(drawn, 2, x0, box.y0);
  Plane plane(drawn, x0, box.y0);
  for (std::uint32_t y = box.y0; y < box.y1; ++y) {
    Ints at_a = a.row, at_b = b.row, at_c = c.row;
    Pair left = plane.left, right = plane.right;
    for (std::uint32_t x = x0; x < box.x1; x += lanes) {
      take(y * tile_side + x, (at_a | at_b | at_c) >= 0, rounded(left, right));
      at_a += a.step, at_b += b.step, at_c += c.step;
      left += plane.step, right += plane.step;
    }
    a.row += a.step_y, b.row += b.step_y, c.row += c.step_y;
    plane.left += plane.step_y, plane.right += plane.step_y;
  }
}

// Where the edges of a triangle cross the rows of a tile: a row's pixels are those from the greatest of `first` up to
// the least of `end`, rounded down. An edge function e + step x of whole numbers is not below 0 where e + 1/2 + step x
// is above 0. That is 0 at a place 1/(2 step) or more away from every pixel, and no step exceeds 2^32: places in the
// tile are known a hundred times better, in double precision and with an addition a row.
struct Crossings {
  Pair first{0, 0}, end{tile_side, tile_side};
  Pair first_step{0, 0}, end_step{0, 0};  // per row

  Crossings(const Drawn& drawn, std::uint32_t y) {
    std::size_t firsts = 0, ends = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      // Along a row that an edge runs along, all is in or nothing: a slope that no row sees the end of.
      constexpr double level = 1.0 / 1024;
      const double step = drawn.step_x[k] == 0 ? level : static_cast<double>(drawn.step_x[k]), inverse = 1 / step;
      const double at = 1 - (static_cast<double>(edge_at(drawn, k, 0, y)) + 0.5) * inverse;
      const double per_row = -static_cast<double>(drawn.step_y[k]) * inverse;
      if (step > 0) {
        first[firsts] = at, first_step[firsts++] = per_row;
      } else {
        end[ends] = at, end_step[ends++] = per_row;
      }
    }
  }
};

// As walk_box, for any triangle, and of each row only what is in it.
template <typename Take>
void walk_rows(const Drawn& drawn, const Box& box, const Take& take) {
  const std::uint32_t x0 = box.x0 / lanes * lanes;
  Crossings crossings(drawn, box.y0);
  Plane plane(drawn, x0, box.y0);
  const double low = box.x0, high = box.x1;
  for (std::uint32_t y = box.y0; y < box.y1; ++y) {
    const auto first =
        static_cast<std::int32_t>(std::min(std::max({crossings.first[0], crossings.first[1], low}), high));
    const auto end = static_cast<std::int32_t>(std::max(std::min({crossings.end[0], crossings.end[1], high}), low));
    if (first < end) {
      const std::uint32_t start = static_cast<std::uint32_t>(first) / lanes * lanes;
      const double skipped = (start - x0) / lanes;
      Pair left = plane.left + skipped * plane.step, right = plane.right + skipped * plane.step;
      Ints column = static_cast<std::int32_t>(start) + Ints{0, 1, 2, 3};
      for (std::uint32_t x = start; x < static_cast<std::uint32_t>(end); x += lanes) {
        take(y * tile_side + x, (column >= first) & (column < end), rounded(left, right));
        column += static_cast<std::int32_t>(lanes);
        left += plane.step, right += plane.step;
      }
    }
    crossings.first += crossings.first_step, crossings.end += crossings.end_step;
    plane.left += plane.step_y, plane.right += plane.step_y;
  }
}

}  // namespace quadgraph::cpu
