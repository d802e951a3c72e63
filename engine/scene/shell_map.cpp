#include "engine/scene/shell_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "engine/base/all_cores.h"
#include "engine/scene/harmonic.h"

namespace quadgraph {
namespace {

constexpr double mixed_from = 0.7;       // of the largest component of a normal: from which on another one counts
constexpr double own_depth = 0.75;       // of the depth that a place must have below the source's own surface
constexpr double core_tolerance = 1e-6;  // of what is interpolated

// A place of the source, mm, before it is brought into the source, and what it counts; those of one `side` follow from
// neighbours smoothly.
struct Draw {
  double weight = 0;
  glm::dvec3 place{0};
  int side = 0;
};

// What a place of the body is made of: up to three draws, the first of which counts most.
struct Carried {
  std::array<Draw, 3> draws{};
  double depth = 0;        // mm below the body's surface
  bool shell = true;       // not deeper than the source goes by its places
  std::uint32_t face = 0;  // of the body, the nearest one
};

// What the stretch is told by, of one cell: the draw that counts most.
struct Taken {
  glm::dvec3 place{0};
  double depth = 0;
  int side = 0;
  bool shell = true;
};

class ShellMap {
 public:
  // `cell`: mm of the body, from a place to the next one that is asked for.
  ShellMap(const SourceDomain& source, const MaterialMap& map, const BodySurface& body, double cell)
      : source_(source), body_(body), scale_(double{map.scale}), repeat_(map.repeat), cell_(cell) {
    depth_ = map.depth          ? double{*map.depth}
             : source.surface() ? std::numeric_limits<double>::max()
                                : source.least_side() / 2;
  }

  // `beside`: what was found close by.
  Carried at(const glm::dvec3& place, const std::optional<Carried>& beside) const {
    const SurfacePlace below = body_.find(place, beside ? std::optional(beside->face) : std::nullopt);
    Carried carried = source_.surface() ? from_body(place, below) : from_block(below);
    carried.depth = below.depth;
    carried.face = below.face;
    carried.shell = carried.shell && below.depth <= scale_ * depth_;
    return carried;
  }

  // What is between given values and is not given itself. The first cells below the shell have what is at its end.
  bool core(const Carried& carried) const {
    if (carried.depth <= 0) return false;
    return source_.surface() ? !carried.shell : carried.depth > scale_ * depth_ + cell_;
  }

  // Whether all within `reach` mm of a place are as it is: in the core, or so far outside that nothing is asked.
  bool alike(const Carried& carried, double reach) const {
    return std::abs(carried.depth) - reach > (carried.depth > 0 ? scale_ * depth_ + cell_ : 2 * cell_);
  }

  void add(const Carried& carried, std::span<float> sums) const {
    for (const Draw& draw : carried.draws) {
      if (draw.weight == 0) continue;
      glm::dvec3 place = draw.place;
      for (int axis = 0; axis < 3; ++axis) {
        if (!source_.cells().varies_along(axis)) place[axis] = source_.cells().low()[axis];
        if (axis != draw.side % 3 && !source_.surface()) place[axis] = source_.within(place[axis], axis, repeat_);
      }
      source_.cells().add(place, draw.weight, sums);
    }
  }

 private:
  Carried from_block(const SurfacePlace& below) const {
    const glm::dvec3 normal = body_.creased_normal(below), size = glm::abs(normal);
    const double most = std::max({size.x, size.y, size.z});
    Carried carried;
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      Draw& draw = carried.draws[static_cast<std::size_t>(axis)];
      const double above = std::max(size[axis] / most - mixed_from, 0.0) / (1 - mixed_from);
      draw.weight = above * above;
      sum += draw.weight;
      const bool high = normal[axis] > 0;
      draw.side = axis + (high ? 3 : 0);
      draw.place = source_.middle() + (below.point - body_.middle()) / scale_;
      const double deep = std::min(below.depth / scale_, depth_);
      draw.place[axis] = high ? source_.high()[axis] - deep : source_.low()[axis] + deep;
    }
    for (Draw& draw : carried.draws) draw.weight /= sum;
    std::sort(carried.draws.begin(), carried.draws.end(),
              [](const Draw& a, const Draw& b) { return a.weight > b.weight; });
    return carried;
  }

  Carried from_body(const glm::dvec3& place, const SurfacePlace& below) const {
    const BodySurface& source = *source_.surface();
    const glm::dvec3 laid = (below.point - body_.middle()) * source_.fit(body_);
    const SurfacePlace there = source.find(source_.middle() + laid);
    const glm::dvec3 in = turned(place - below.point, body_.smooth_normal(below), source.smooth_normal(there)) / scale_;
    Carried carried;
    carried.draws[0] = {.weight = 1, .place = there.point + in, .side = 0};
    const double least = own_depth * below.depth / scale_;
    if (below.depth > 0) carried.shell = source.find(carried.draws[0].place).depth >= least;
    return carried;
  }

  // By the smallest turn that brings one unit vector to another.
  static glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& from, const glm::dvec3& to) {
    const double cosine = glm::dot(from, to);
    if (cosine < -0.999999) return -v;
    const glm::dvec3 axis = glm::cross(from, to);
    return v + glm::cross(axis, v) + glm::cross(axis, glm::cross(axis, v)) / (1 + cosine);
  }

  const SourceDomain& source_;
  const BodySurface& body_;
  double scale_;
  MapRepeat repeat_;
  double cell_;
  double depth_ = 0;  // mm of the source
};

// Calls `visit` with the cells beside one.
template <typename Visit>
void each_neighbour(const CellGrid& grid, std::size_t cell, const Visit& visit) {
  std::size_t step = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t at = cell / step % grid.cells[axis];
    if (at > 0) visit(static_cast<int>(axis), cell - step);
    if (at + 1 < grid.cells[axis]) visit(static_cast<int>(axis), cell + step);
    step *= grid.cells[axis];
  }
}

// The cells deeper than the shell, and those beside them, which are given.
void interpolate_core(const CellGrid& grid, const std::vector<char>& core, std::size_t channels,
                      std::vector<float>& values) {
  std::vector<std::uint32_t> number(grid.count(), 0), cells;
  const auto take = [&](std::size_t cell) {
    if (number[cell] == 0) {
      cells.push_back(static_cast<std::uint32_t>(cell));
      number[cell] = static_cast<std::uint32_t>(cells.size());
    }
    return number[cell] - 1;
  };
  for (std::size_t cell = 0; cell < grid.count(); ++cell) {
    if (!core[cell]) continue;
    take(cell);
    each_neighbour(grid, cell, [&](int, std::size_t beside) { take(beside); });
  }
  WeightedGraph graph{.begin = {0}, .to = {}, .weight = {}};
  std::vector<char> fixed;
  for (std::uint32_t cell : cells) {
    fixed.push_back(core[cell] ? 0 : 1);
    if (core[cell]) {
      each_neighbour(grid, cell, [&](int axis, std::size_t beside) {
        graph.to.push_back(take(beside));
        graph.weight.push_back(1 / (grid.spacing[axis] * grid.spacing[axis]));
      });
    }
    graph.begin.push_back(graph.to.size());
  }
  on_all_cores(channels, [&](std::size_t channel) {
    std::vector<double> solved;
    for (std::uint32_t cell : cells) solved.push_back(double{values[cell * channels + channel]});
    make_harmonic(graph, fixed, solved, core_tolerance);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!fixed[i]) values[cells[i] * channels + channel] = std::max(static_cast<float>(solved[i]), 0.0f);
    }
  });
}

// By differences between the cells on both sides, where all of them are in the shell and follow from each other.
Stretch stretch_of(const CellGrid& grid, const std::vector<Taken>& taken, int axes) {
  StretchCount count(axes);
  for (std::size_t cell = 0; cell < grid.count(); ++cell) {
    const Taken& here = taken[cell];
    if (here.depth <= 0) continue;
    std::array<std::array<const Taken*, 2>, 3> beside{};
    each_neighbour(grid, cell, [&](int axis, std::size_t at) {
      const Taken& there = taken[at];
      if (there.depth > 0 && there.shell && there.side == here.side) {
        beside[static_cast<std::size_t>(axis)][at > cell ? 1 : 0] = &there;
      }
    });
    glm::dmat3 back(0);
    bool whole = here.shell;
    for (std::size_t axis = 0; axis < 3 && whole; ++axis) {
      whole = beside[axis][0] && beside[axis][1];
      if (!whole) break;
      const int k = static_cast<int>(axis);
      back[k] = (beside[axis][1]->place - beside[axis][0]->place) / (2 * grid.spacing[k]);
    }
    if (whole) count.add(back, 1);
  }
  return count.percentiles();
}

glm::dvec3 spacing_of(const SourceDomain& source, double scale) {
  glm::dvec3 spacing = source.cells().grid().spacing;
  double least = std::numeric_limits<double>::max();
  for (int axis = 0; axis < 3; ++axis) {
    if (source.cells().varies_along(axis)) least = std::min(least, spacing[axis]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (!source.cells().varies_along(axis)) spacing[axis] = least;
  }
  return scale * spacing;
}

}  // namespace

MappedVolume shell_mapped(const SourceDomain& source, const MaterialMap& map, const BodySurface& body) {
  MappedVolume made;
  const double scale{map.scale};
  const glm::dvec3 anchor = body.middle() + scale * (source.cells().low() - source.middle());
  const CellGrid grid = grid_around(body.low(), body.high(), anchor, spacing_of(source, scale), made.report.coarser);
  const std::size_t channels = source.cells().channels();
  std::vector<Taken> taken(grid.count());
  std::vector<float> values(grid.count() * channels, 0);
  std::vector<char> core(grid.count(), 0);
  const ShellMap shell(source, map, body, std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z}));
  on_all_cores(grid.cells[1] * grid.cells[2], [&](std::size_t row) {
    std::optional<Carried> carried;
    double reach = 0;  // mm from the place where that was found
    for (std::size_t cell = row * grid.cells[0]; cell < (row + 1) * grid.cells[0]; ++cell) {
      reach += grid.spacing.x;
      if (!carried || !shell.alike(*carried, reach)) {
        carried = shell.at(grid.place(cell), carried);
        reach = 0;
      }
      const Draw& most = carried->draws[0];
      taken[cell] = {.place = most.place, .depth = carried->depth, .side = most.side, .shell = carried->shell};
      core[cell] = shell.core(*carried) ? 1 : 0;
      shell.add(*carried, std::span(values).subspan(cell * channels, channels));
    }
  });
  std::size_t inside = 0, deep = 0;
  for (std::size_t cell = 0; cell < grid.count(); ++cell) {
    inside += taken[cell].depth > 0 ? 1 : 0;
    deep += core[cell] ? 1 : 0;
  }
  if (deep > 0) interpolate_core(grid, core, channels, values);
  made.report.core = static_cast<double>(deep) / static_cast<double>(std::max<std::size_t>(inside, 1));
  made.report.stretch = stretch_of(grid, taken, source.axes());
  made.volume = source.cells().volume_of(grid, values, scale);
  return made;
}

}  // namespace quadgraph
