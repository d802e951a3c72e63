// The rasteriser of the processor: the rules of Vulkan, and the same samples as a Vulkan device draws.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "engine/cpu/processor.h"
#include "engine/device/commands.h"
#include "interface/display/false_colour.frag.h"
#include "interface/display/false_colour.vert.h"
#include "interface/light/shadow.vert.h"
#include "tests/cpp/fixtures/checked_context.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

constexpr std::uint32_t side = 200;  // pixels; more than three tiles, the last of them not full

struct Drawing {
  std::vector<glm::vec3> vertices;  // three per triangle
  device::Cull cull = device::Cull::none;
  glm::mat4 clip_from_world{1};
  device::Viewport viewport{0, 0, side, side};
  device::Depth depth = device::Depth::rises;
};

// 1 less the depth.
glm::mat4 turned_round(glm::mat4 clip) {
  for (int column = 0; column < 4; ++column) clip[column][2] = clip[column][3] - clip[column][2];
  return clip;
}

// Depth of every pixel as it rises, 1 where there is none.
std::vector<float> drawn(device::Device& device, const Drawing& what) {
  const auto vertices = device::upload<glm::vec3>(device, what.vertices, "test/vertices");
  const bool falls = what.depth == device::Depth::falls;
  const device::GraphicsPass pass(
      device, {.vertex = &shader::shadow_vert, .fragment = nullptr, .cull = what.cull, .depth = what.depth}, "depth");
  const device::Image image(device, {device::Format::depth32_float, side, side}, "test/depth");
  const device::Buffer depth(device, side * side * sizeof(float), device::Place::device, "test/copy");
  const glm::mat4 clip = falls ? turned_round(what.clip_from_world) : what.clip_from_world;
  device::Commands commands(device);
  commands.draw({{}, &image}, what.viewport, pass, gpu::ShadowPush{clip, vertices.address()}, nullptr,
                static_cast<std::uint32_t>(what.vertices.size()));
  commands.copy(image, depth);
  commands.submit_and_wait();
  std::vector<float> depths = device::download<float>(device, depth);
  if (falls) std::ranges::transform(depths, depths.begin(), [](float z) { return 1 - z; });
  return depths;
}

std::vector<float> drawn(const Drawing& what, unsigned threads = 0) {
  cpu::Processor processor({.threads = threads});
  return drawn(processor, what);
}

std::size_t covered(const std::vector<float>& depth) {
  return static_cast<std::size_t>(std::count_if(depth.begin(), depth.end(), [](float z) { return z < 1; }));
}

float at(const std::vector<float>& depth, std::uint32_t x, std::uint32_t y) {
  return depth[y * side + x];
}

// Counter-clockwise in the window with y up, all of it at depth z.
std::vector<glm::vec3> corner(float size, float z) {
  return {{-1, -1, z}, {-1 + size, -1, z}, {-1, -1 + size, z}};
}

// Triangles of all sizes and directions, in the window and across its borders.
std::vector<glm::vec3> scattered(std::uint32_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-1.2f, 1.2f), depth(0.05f, 0.95f), size(-5, 0);
  std::vector<glm::vec3> vertices;
  for (std::uint32_t t = 0; t < count; ++t) {
    const glm::vec3 middle(place(random), place(random), depth(random));
    const float width = std::exp2(size(random));
    for (int k = 0; k < 3; ++k)
      vertices.push_back(middle + width * glm::vec3(place(random), place(random), 0.05f * place(random)));
  }
  return vertices;
}

// As a camera at the origin that looks along +z, with depth 0 at z = near and 1 at z = far.
glm::mat4 perspective(float near, float far) {
  glm::mat4 clip(0);
  clip[0][0] = clip[1][1] = 1;
  clip[2] = {0, 0, far / (far - near), 1};
  clip[3] = {0, 0, -near * far / (far - near), 0};
  return clip;
}

struct Difference {
  std::size_t samples = 0;  // that show another surface, or that only one of them covers
  double depth = 0;         // largest of the others
};

Difference samples_apart(const std::vector<float>& a, const std::vector<float>& b) {
  Difference result;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double apart = std::abs(double{a[k]} - double{b[k]});
    if ((a[k] < 1) != (b[k] < 1) || apart > 1e-3) {
      ++result.samples;
    } else {
      result.depth = std::max(result.depth, apart);
    }
  }
  return result;
}

// The rules in plain words, of one triangle that nothing clips: a sample is in it, or on a left edge or a top one.
std::vector<float> plainly_drawn(const std::vector<glm::vec3>& corners) {
  struct Place {
    std::int64_t x, y;  // 1/256 of a pixel, y down
  };
  std::array<Place, 3> at;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 corner(corners[k]);
    at[k] = {std::lrint(256 * (0.5 * (1 + corner.x) * side)), std::lrint(256 * (0.5 * (1 - corner.y) * side))};
  }
  const auto turn = [](Place a, Place b, Place c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); };
  const std::int64_t area = turn(at[0], at[1], at[2]), sign = area < 0 ? -1 : 1;
  std::vector<float> depths(side * side, 1);
  for (std::uint32_t pixel = 0; area != 0 && pixel < side * side; ++pixel) {
    const Place sample{256 * std::int64_t{pixel % side} + 128, 256 * std::int64_t{pixel / side} + 128};
    bool in = true;
    double depth = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Place a = at[(k + 1) % 3], b = at[(k + 2) % 3];
      const std::int64_t inside = sign * turn(a, b, sample), to_right = sign * (a.y - b.y), down = sign * (b.x - a.x);
      in = in && (inside > 0 || (inside == 0 && (to_right > 0 || (to_right == 0 && down > 0))));
      depth += static_cast<double>(turn(a, b, sample)) / static_cast<double>(area) * double{corners[k].z};
    }
    if (in) depths[pixel] = static_cast<float>(depth);
  }
  return depths;
}

// Triangles of one kind: corners `apart` from each other, rounded to multiples of `grid`, both in pixels, around places
// up to `out` halves of the window from its middle; `flat` times as wide as high.
struct Kind {
  const char* name;
  float apart, grid, out, flat;
};

std::vector<glm::vec3> one_of(const Kind& kind, std::mt19937& random) {
  std::uniform_real_distribution<float> place(-1, 1), depth(0.05f, 0.95f);
  const glm::vec2 middle = kind.out * glm::vec2(place(random), place(random));
  std::vector<glm::vec3> corners;
  for (int k = 0; k < 3; ++k) {
    glm::vec2 pixels = 0.5f * side * middle + kind.apart * glm::vec2(place(random), place(random) / kind.flat);
    pixels = kind.grid * glm::round(pixels / kind.grid) + glm::vec2(0.5f);
    corners.emplace_back(pixels / (0.5f * side), depth(random));
  }
  return corners;
}

}  // namespace

TEST_CASE("a triangle of any size covers what a plain loop over all samples finds, as deep") {
  cpu::Processor processor;
  std::mt19937 random(5);
  constexpr float fine = 1.0f / 256;
  for (const Kind& kind :
       {Kind{"small", 4, fine, 1, 1}, Kind{"as wide as a tile", 60, fine, 1, 1}, Kind{"large", 200, fine, 1, 1},
        Kind{"corners at samples", 10, 1, 1, 1}, Kind{"large, corners at samples", 150, 1, 1, 1},
        Kind{"slivers", 150, fine, 1, 100}, Kind{"upright slivers", 1.5f, fine, 1, 0.01f},
        Kind{"slivers at samples", 150, 1, 1, 100}, Kind{"huge", 10000, fine, 20, 1},
        Kind{"huge, corners at samples", 10000, 1, 20, 1}, Kind{"huge slivers", 10000, fine, 1, 1000},
        Kind{"across the border and outside", 60, fine, 2.5f, 1}}) {
    CAPTURE(kind.name);
    std::size_t samples = 0, wrong = 0;
    double deep = 0;
    for (int round = 0; round < 60; ++round) {
      const std::vector<glm::vec3> corners = one_of(kind, random);
      const std::vector<float> found = drawn(processor, {.vertices = corners}), wanted = plainly_drawn(corners);
      for (std::size_t k = 0; k < found.size(); ++k) {
        samples += wanted[k] < 1 ? 1 : 0;
        wrong += (found[k] < 1) != (wanted[k] < 1) ? 1 : 0;
        if (found[k] < 1 && wanted[k] < 1) deep = std::max(deep, std::abs(double{found[k]} - double{wanted[k]}));
      }
    }
    CHECK(samples > 20);
    CHECK(wrong == 0);
    CHECK(deep < 1e-6);
  }
}

TEST_CASE("the samples of a triangle are those within it, the top-left rule on its borders") {
  // Half of a square of 100 pixels, its right angle lower left: rows of 1 to 100 pixels, less those on the diagonal.
  const std::vector<float> depth = drawn({.vertices = corner(1, 0.25f)});
  CHECK(covered(depth) == 99 * 100 / 2);
  CHECK(at(depth, 0, side - 1) == 0.25f);
  CHECK(at(depth, 98, side - 1) == 0.25f);
  CHECK(at(depth, 99, side - 1) == 1);  // on the diagonal, a right edge
  CHECK(at(depth, 0, 101) == 0.25f);
  CHECK(at(depth, 0, 100) == 1);
}

TEST_CASE("triangles that share edges cover every sample of their union once") {
  // A fan around a point off the centre, to points around it; pairs of triangles share an edge that crosses samples.
  std::mt19937 random(11);
  std::uniform_int_distribution<int> sample(20, 180);
  for (int round = 0; round < 20; ++round) {
    CAPTURE(round);
    const auto centre_of_pixel = [](int x, int y) {
      return glm::vec2((static_cast<float>(x) + 0.5f) / (0.5f * side) - 1,
                       (static_cast<float>(y) + 0.5f) / (0.5f * side) - 1);
    };
    const glm::vec2 middle = centre_of_pixel(sample(random), sample(random));
    std::vector<glm::vec2> ring;
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 5; ++i) {
        const int along = 10 + i * 36;
        const std::array<glm::vec2, 4> at_side = {centre_of_pixel(along, 10), centre_of_pixel(190, along),
                                                  centre_of_pixel(200 - along, 190), centre_of_pixel(10, 200 - along)};
        ring.push_back(at_side[k]);
      }
    }
    std::size_t sum = 0;
    std::vector<glm::vec3> all;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const glm::vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      const std::vector<glm::vec3> one = {{middle, 0.5f}, {a, 0.5f}, {b, 0.5f}};
      sum += covered(drawn({.vertices = one}));
      all.insert(all.end(), one.begin(), one.end());
    }
    const std::size_t together = covered(drawn({.vertices = all}));
    CHECK(together == 180 * 180);  // one of the two borders on either axis
    CHECK(sum == together);
  }
}

TEST_CASE("of two triangles the nearer one is seen, in either order, and the first of equals stays") {
  for (const bool near_first : {false, true}) {
    std::vector<glm::vec3> vertices = corner(1, near_first ? 0.25f : 0.75f);
    const std::vector<glm::vec3> other = corner(1.5f, near_first ? 0.75f : 0.25f);
    vertices.insert(vertices.end(), other.begin(), other.end());
    const std::vector<float> depth = drawn({.vertices = vertices});
    CHECK(at(depth, 3, side - 3) == 0.25f);
    CHECK(at(depth, 120, side - 3) == (near_first ? 0.75f : 0.25f));
  }
}

TEST_CASE("a side is drawn or not as culling says, counter-clockwise being the front") {
  const std::vector<glm::vec3> front = corner(1, 0.25f), back = {front[0], front[2], front[1]};
  const std::size_t all = covered(drawn({.vertices = front}));
  CHECK(all > 4000);
  CHECK(covered(drawn({.vertices = back})) == all);
  CHECK(covered(drawn({.vertices = front, .cull = device::Cull::back})) == all);
  CHECK(covered(drawn({.vertices = back, .cull = device::Cull::back})) == 0);
  CHECK(covered(drawn({.vertices = front, .cull = device::Cull::front})) == 0);
  CHECK(covered(drawn({.vertices = back, .cull = device::Cull::front})) == all);
}

TEST_CASE("a floor that goes on behind the eye is cut at the near plane, and at the far one") {
  // y = -1 from z = -50 to 50: seen in the lower half, from the row where it is at depth 0 up to that at depth 1.
  const Drawing floor{
      .vertices = {{-80, -1, -50}, {80, -1, -50}, {-80, -1, 50}, {80, -1, -50}, {80, -1, 50}, {-80, -1, 50}},
      .clip_from_world = perspective(2, 10)};
  const std::vector<float> depth = drawn(floor);
  for (std::uint32_t row = 0; row < side; ++row) {
    const double y = 1 - (row + 0.5) / (0.5 * side), z = -1 / y;  // mm from the eye
    CAPTURE(row);
    for (const std::uint32_t column : {0u, 77u, side - 1}) {
      if (y > -0.1 || z < 2) {
        CHECK(at(depth, column, row) == 1);
      } else {
        CHECK(at(depth, column, row) == doctest::Approx(10.0 / 8 * (1 - 2 / z)).epsilon(1e-4));
      }
    }
  }
  CHECK(covered(depth) == 40 * side);
}

TEST_CASE("a clipped triangle has the flat values of its first corner") {
  cpu::Processor processor;
  // The first corner lies before the near plane; it alone says that the triangle is grey whatever its value.
  std::vector<gpu::FalseVertex> corners = {
      {{-1, -1, -0.5f}, 1, gpu::FALSE_PLAIN}, {{3, -1, 0.5f}, 1, 0}, {{-1, 3, 0.5f}, 1, 0}};
  const auto vertices = device::upload<gpu::FalseVertex>(processor, corners, "test/vertices");
  const device::GraphicsPass pass(processor,
                                  {.vertex = &shader::false_colour_vert,
                                   .fragment = &shader::false_colour_frag,
                                   .colours = 3,
                                   .cull = device::Cull::none},
                                  "false colour");
  const device::ImageOptions colour{device::Format::rgba32_float, side, side};
  const device::Image first(processor, colour, "test/colour"), second(processor, colour, "test/colour");
  const device::Image third(processor, colour, "test/colour");
  const device::Image depth(processor, {device::Format::depth32_float, side, side}, "test/depth");
  const device::Buffer pixels(processor, side * side * sizeof(glm::vec4), device::Place::device, "test/copy");
  device::Commands commands(processor);
  commands.draw({{&first, &second, &third}, &depth}, {0, 0, side, side}, pass,
                gpu::FalseColourPush{.clip_from_offset = glm::mat4(1),
                                     .vertices = vertices.address(),
                                     .origin = {},
                                     .eye = {},
                                     .plane = {},
                                     .diverging = 0},
                nullptr, 3);
  commands.copy(first, pixels);
  commands.submit_and_wait();
  std::size_t seen = 0;
  for (const glm::vec4& pixel : device::download<glm::vec4>(processor, pixels)) {
    if (pixel.w == 0) continue;
    ++seen;
    REQUIRE(glm::vec3(pixel) == glm::vec3(0.16f, 0.165f, 0.175f));
  }
  CHECK(seen > side * side / 4);
}

TEST_CASE("an image that is drawn into again shows nothing of the draws before, in any size") {
  cpu::Processor processor;
  const device::GraphicsPass pass(processor, {.vertex = &shader::shadow_vert, .fragment = nullptr}, "depth");
  const device::Image used(processor, {device::Format::depth32_float, side, side}, "test/depth");
  // A half of it, nothing, a corner; of 130 and 190 pixels too, which are as many tiles.
  const std::vector<std::pair<float, std::uint32_t>> draws = {{2, 190}, {0, 190}, {0.3f, 190}, {0, 190},    {2, 190},
                                                              {0, 130}, {0, 190}, {2, side},   {0.3f, side}};
  for (const auto& [size, width] : draws) {
    CAPTURE(size);
    CAPTURE(width);
    const auto vertices = device::upload<glm::vec3>(processor, corner(size, 0.25f), "test/vertices");
    const auto depth_in = [&](const device::Image& image) {
      const device::Buffer depth(processor, width * width * sizeof(float), device::Place::device, "test/copy");
      device::Commands commands(processor);
      commands.draw({{}, &image, width, width}, {0, 0, static_cast<float>(width), static_cast<float>(width)}, pass,
                    gpu::ShadowPush{glm::mat4(1), vertices.address()}, nullptr, 3);
      commands.copy(image, depth, width, width);
      commands.submit_and_wait();
      return device::download<float>(processor, depth);
    };
    const device::Image fresh(processor, {device::Format::depth32_float, side, side}, "test/depth");
    CHECK(depth_in(used) == depth_in(fresh));
  }
}

TEST_CASE("what is drawn does not depend on the number of threads") {
  Drawing what{.vertices = scattered(3000)};
  const std::vector<float> alone = drawn(what, 1);
  CHECK(covered(alone) > side * side / 2);
  for (const unsigned threads : {2u, 7u}) CHECK(drawn(what, threads) == alone);
}

TEST_CASE("what is nearest is seen, whether depth rises or falls") {
  Drawing what{.vertices = scattered(500)};
  const std::vector<float> rises = drawn(what);
  what.depth = device::Depth::falls;
  const Difference apart = samples_apart(rises, drawn(what));
  CHECK(apart.samples == 0);
  CHECK(apart.depth < 1e-6);
}

TEST_CASE("the processor and a Vulkan device cover the same samples at the same depth") {
  CheckedContext vulkan(test_vulkan_device());
  // Both round corners to 1/256 of a pixel, from clip coordinates in double here and in float there. Where that rounds
  // a corner the other way, which is one in 250, its edges move by 1/256 of a pixel, and less than one sample of 256
  // along them changes sides: of 1500 corners, about one sample in all.
  const auto compare = [&](const Drawing& what) {
    const std::vector<float> here = drawn(what);
    CHECK(covered(here) > side * side / 20);
    const Difference apart = samples_apart(here, drawn(vulkan.context, what));
    CHECK(apart.samples <= 4);
    CHECK(apart.depth < 2e-4);  // the plane through the corners, in float there, of slivers at its worst
  };
  for (const device::Cull cull : {device::Cull::none, device::Cull::back, device::Cull::front}) {
    compare({.vertices = scattered(500), .cull = cull});
  }
  std::vector<glm::vec3> ahead = scattered(500);
  for (glm::vec3& p : ahead) p = {8.0f * p.x, 8.0f * p.y, 12.0f * p.z - 1.0f};  // some behind the eye
  compare({.vertices = ahead, .clip_from_world = perspective(0.5f, 9)});
  compare({.vertices = scattered(500), .viewport = {-150, -90, 400, 300}});
  compare({.vertices = scattered(500), .depth = device::Depth::falls});
}
