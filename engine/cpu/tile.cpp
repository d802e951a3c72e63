#include "engine/cpu/tile.h"

#include <algorithm>

namespace quadgraph::cpu {
namespace {

using Words = std::uint32_t __attribute__((vector_size(16)));
using Longs = std::int64_t __attribute__((vector_size(16)));
using StoredFloats = float __attribute__((vector_size(16), aligned(4)));

bool any(Ints mask) {
  const auto halves = Longs(mask);
  return (halves[0] | halves[1]) != 0;
}

std::int32_t first_pixel(std::int32_t at) {
  return (at + pixel / 2 - 1) >> 8;
}
std::int32_t last_pixel(std::int32_t at) {
  return (at - pixel / 2) >> 8;
}

// Values of one fragment: `b` are weights in the window, which add up to 1.
void interpolate(const Triangle& t, const std::array<double, 3>& b, std::uint32_t locations, std::uint32_t flat,
                 float* result) {
  std::array<float, 3> weight;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += b[k] * t.inverse_w[k];
  const double inverse = 1 / sum;
  for (std::size_t k = 0; k < 3; ++k) weight[k] = static_cast<float>(b[k] * t.inverse_w[k] * inverse);
  const auto four = [](const float* values, std::uint32_t location) -> Floats {
    return *reinterpret_cast<const StoredFloats*>(values + 4 * location);
  };
  for (std::uint32_t k = 0; k < locations; ++k) {
    *reinterpret_cast<StoredFloats*>(result + 4 * k) =
        (flat >> k & 1u) != 0
            ? four(t.flat, k)
            : weight[0] * four(t.values[0], k) + weight[1] * four(t.values[1], k) + weight[2] * four(t.values[2], k);
  }
}

ImageMemory& image(device::ImageMemory* memory) {
  return static_cast<ImageMemory&>(*memory);
}

}  // namespace

Batch::Batch(const Frame& frame) : frame_(frame), derivatives_(false) {
  if (frame.pass.fragment == nullptr) return;
  derivatives_ = frame.pass.options.fragment->derivatives;
  const std::size_t floats = std::size_t{4} * frame.locations() * fragments_at_once;
  inputs_.resize(floats);
  if (derivatives_) {
    right_.resize(floats);
    below_.resize(floats);
  }
  colours_.resize(4 * frame.target.colours.size() * fragments_at_once);
}

// Triangles of a batch are turned the same way.
bool Batch::has_room(const Triangle& t) const {
  return count_ < fragments_at_once && (count_ == 0 || front_ == t.front);
}

void Batch::take(const Drawn& drawn, std::uint32_t pixel_of_tile, float z) {
  front_ = drawn.triangle->front;
  pixels_[count_] = pixel_of_tile;
  depths_[count_] = z;
  const std::uint32_t flat = frame_.pass.options.vertex->flat;
  const std::size_t place = std::size_t{4} * frame_.locations() * count_++;
  const std::uint32_t x = pixel_of_tile % tile_side, y = pixel_of_tile / tile_side;
  std::array<double, 3> b, right, below;
  for (std::size_t k = 0; k < 3; ++k) {
    b[k] = drawn.inverse * static_cast<double>(drawn.at[k] + x * drawn.step_x[k] + y * drawn.step_y[k]);
    right[k] = b[k] + drawn.inverse * static_cast<double>(drawn.step_x[k]);
    below[k] = b[k] + drawn.inverse * static_cast<double>(drawn.step_y[k]);
  }
  interpolate(*drawn.triangle, b, frame_.locations(), flat, inputs_.data() + place);
  if (!derivatives_) return;
  interpolate(*drawn.triangle, right, frame_.locations(), flat, right_.data() + place);
  interpolate(*drawn.triangle, below, frame_.locations(), flat, below_.data() + place);
}

template <typename Keep>
void Batch::shade(std::uint64_t texel, const Keep& keep) {
  if (count_ == 0) return;
  frame_.pass.fragment(frame_.push, front_, inputs_.data(), right_.data(), below_.data(), count_, colours_.data(),
                       kept_.data(), frame_.pass.options.variant);
  const std::size_t images = frame_.target.colours.size();
  for (std::size_t i = 0; i < images; ++i) {
    const ImageMemory& target = image(frame_.target.colours[i]);
    const std::uint32_t words = target.words();
    for (std::uint32_t k = 0; k < count_; ++k) {
      if (!kept_[k]) continue;
      const std::uint64_t at =
          texel + std::uint64_t{pixels_[k] / tile_side} * target.options.width + pixels_[k] % tile_side;
      std::copy_n(colours_.data() + 4 * (images * k + i), words, target.texels() + words * at);
    }
  }
  for (std::uint32_t k = 0; k < count_; ++k) {
    if (kept_[k]) keep(pixels_[k], depths_[k]);
  }
  count_ = 0;
}

Tile::Tile(const Frame& frame)
    : frame_(frame),
      depth_(image(frame.target.depth)),
      batch_(frame),
      alike_(frame.pass.fragment != nullptr && !frame.pass.options.fragment->derivatives &&
             frame.pass.options.vertex->flat == (1u << frame.locations()) - 1) {}

Drawn Tile::drawn(const Triangle& t) const {
  Drawn drawn{};
  drawn.triangle = &t;
  const std::int64_t first_x = std::int64_t{pixel} * left_ + pixel / 2,
                     first_y = std::int64_t{pixel} * top_ + pixel / 2;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = (k + 1) % 3, to = (k + 2) % 3;
    const std::int64_t dx = t.x[to] - t.x[from], dy = t.y[to] - t.y[from];
    drawn.at[k] = dy * (first_x - t.x[from]) - dx * (first_y - t.y[from]);
    drawn.step_x[k] = dy * pixel;
    drawn.step_y[k] = -dx * pixel;
  }
  const std::int64_t twice =
      std::int64_t{t.x[2] - t.x[0]} * (t.y[1] - t.y[0]) - std::int64_t{t.x[1] - t.x[0]} * (t.y[2] - t.y[0]);
  drawn.inverse = 1.0 / static_cast<double>(twice);
  return drawn;
}

template <typename Each>
void Tile::for_each(const DrawMemory& memory, const Each& each) const {
  const auto clamped = [](std::int32_t at, std::uint32_t first, std::uint32_t size) {
    return static_cast<std::uint32_t>(
        std::clamp(at - static_cast<std::int32_t>(first), 0, static_cast<std::int32_t>(size)));
  };
  constexpr std::uint32_t ahead = 4;  // triangles that memory is asked for
  for (std::uint32_t p = 0; p < memory.part_count; ++p) {
    const Part& part = memory.parts[p];
    const std::uint32_t end = part.first[number_ + 1];
    for (std::uint32_t k = part.first[number_]; k < end; ++k) {
      const char* next = reinterpret_cast<const char*>(&part.triangles[part.of_tile[std::min(k + ahead, end - 1)]]);
      __builtin_prefetch(next);
      __builtin_prefetch(next + sizeof(Triangle) - 1);
      const Triangle& t = part.triangles[part.of_tile[k]];
      const auto [least_x, most_x] = std::minmax({t.x[0], t.x[1], t.x[2]});
      const auto [least_y, most_y] = std::minmax({t.y[0], t.y[1], t.y[2]});
      const Box box{clamped(first_pixel(least_x), left_, width_), clamped(first_pixel(least_y), top_, height_),
                    clamped(last_pixel(most_x) + 1, left_, width_), clamped(last_pixel(most_y) + 1, top_, height_)};
      if (box.x0 >= box.x1 || box.y0 >= box.y1) continue;
      const Drawn one = drawn(t);
      // All pixels around a small triangle are looked at sooner than the ends of its rows are found. Its edges are
      // below 2^31 there.
      constexpr std::int32_t narrow = 32 * pixel, low = 30000;
      const bool small = most_x - least_x <= narrow && most_y - least_y <= low;
      each(one, [&](const auto& take) { small ? walk_box(one, box, take) : walk_rows(one, box, take); });
    }
  }
}

// Depth alone.
void Tile::draw_depths(const DrawMemory& memory) {
  for_each(memory, [&](const Drawn&, const auto& walk_over) {
    walk_over([&](std::uint32_t at, Ints mask, Floats z) {
      auto& depths = *reinterpret_cast<Floats*>(&depths_[at]);
      depths = (mask & (z < depths)) != 0 ? z : depths;
    });
  });
}

// Finds what is seen at each pixel, then shades that.
void Tile::draw_seen(const DrawMemory& memory) {
  drawn_.clear();
  seen_.fill(none);
  for_each(memory, [&](const Drawn& drawn, const auto& walk_over) {
    const auto number = static_cast<std::uint32_t>(drawn_.size());
    Ints seen{};
    walk_over([&](std::uint32_t at, Ints mask, Floats z) {
      auto& depths = *reinterpret_cast<Floats*>(&depths_[at]);
      auto& numbers = *reinterpret_cast<Words*>(&seen_[at]);
      const Ints nearer = mask & (z < depths);
      depths = nearer != 0 ? z : depths;
      numbers = nearer != 0 ? number + Words{} : numbers;
      seen |= nearer;
    });
    if (any(seen)) drawn_.push_back(drawn);
  });
  if (alike_) return write_alike();
  const auto keep = [](std::uint32_t, float) {};
  for (std::uint32_t y = 0; y < height_; ++y) {
    const std::uint32_t end = y * tile_side + width_;
    for (std::uint32_t at = y * tile_side; at < end; ++at) {
      if (seen_[at] == none) {
        const std::uint32_t first = at;
        while (at + 1 < end && seen_[at + 1] == none) ++at;
        leave_empty(first, at + 1 - first);
        continue;
      }
      const Drawn& drawn = drawn_[seen_[at]];
      if (!batch_.has_room(*drawn.triangle)) batch_.shade(texel_, keep);
      batch_.take(drawn, at, depths_[at]);
    }
  }
  batch_.shade(texel_, keep);
}

// What is seen, where all fragments of a triangle are the same: each is shaded once.
void Tile::write_alike() {
  const std::size_t images = frame_.target.colours.size();
  alike_colours_.assign(4 * images * (drawn_.size() + 1), 0.0f);  // the last of nothing
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    bool kept = true;
    frame_.pass.fragment(frame_.push, drawn_[k].triangle->front, drawn_[k].triangle->flat, nullptr, nullptr, 1,
                         alike_colours_.data() + 4 * images * k, &kept, frame_.pass.options.variant);
  }
  for (std::size_t i = 0; i < images; ++i) {
    const ImageMemory& target = image(frame_.target.colours[i]);
    const std::uint32_t words = target.words();
    for (std::uint32_t y = 0; y < height_; ++y) {
      float* texels = target.texels() + words * (texel_ + std::uint64_t{y} * target.options.width);
      for (std::uint32_t x = 0; x < width_; ++x) {
        const std::size_t seen = std::min<std::size_t>(seen_[y * tile_side + x], drawn_.size());
        std::copy_n(alike_colours_.data() + 4 * (images * seen + i), words, texels + std::size_t{words} * x);
      }
    }
  }
}

// Shades all that is nearer than what came before, as fragments may be discarded.
void Tile::draw_in_order(const DrawMemory& memory) {
  const auto keep = [&](std::uint32_t at, float z) { depths_[at] = z; };
  for_each(memory, [&](const Drawn& drawn, const auto& walk_over) {
    walk_over([&](std::uint32_t at, Ints mask, Floats z) {
      for (std::uint32_t lane = 0; lane < lanes; ++lane) {
        if (mask[lane] == 0 || !(z[lane] < depths_[at + lane]) || at % tile_side + lane >= width_) continue;
        if (!batch_.has_room(*drawn.triangle)) batch_.shade(texel_, keep);
        batch_.take(drawn, at + lane, z[lane]);
      }
    });
    batch_.shade(texel_, keep);
  });
}

void Tile::leave_empty(std::uint32_t pixel_of_tile, std::uint32_t count) const {
  const std::uint32_t x = pixel_of_tile % tile_side, y = pixel_of_tile / tile_side;
  for (device::ImageMemory* colour : frame_.target.colours) {
    const ImageMemory& target = image(colour);
    const std::uint32_t words = target.words();
    std::fill_n(target.texels() + words * (texel_ + std::uint64_t{y} * target.options.width + x), words * count, 0.0f);
  }
}

bool Tile::is_empty(const DrawMemory& memory) const {
  for (std::uint32_t p = 0; p < memory.part_count; ++p) {
    if (memory.parts[p].first[number_] != memory.parts[p].first[number_ + 1]) return false;
  }
  return true;
}

// Unless it is clear from an earlier draw.
void Tile::clear(ImageMemory& target, float value) const {
  if (target.clear_tiles[number_] != 0) return;
  const std::uint32_t words = target.words();
  for (std::uint32_t y = 0; y < height_; ++y) {
    std::fill_n(target.texels() + words * (texel_ + std::uint64_t{y} * target.options.width), words * width_, value);
  }
  target.clear_tiles[number_] = 1;
}

void Tile::write_depths() {
  if (frame_.pass.options.depth == device::Depth::falls) {
    for (float& depth : depths_) depth = -depth;
  }
  for (std::uint32_t y = 0; y < height_; ++y) {
    std::copy_n(depths_.data() + y * tile_side, width_,
                depth_.texels() + texel_ + std::uint64_t{y} * depth_.options.width);
  }
}

void Tile::draw(std::uint32_t number, const DrawMemory& memory) {
  number_ = number;
  left_ = number % frame_.columns() * tile_side;
  top_ = number / frame_.columns() * tile_side;
  width_ = std::min(tile_side, frame_.target.width - left_);
  height_ = std::min(tile_side, frame_.target.height - top_);
  texel_ = std::uint64_t{top_} * depth_.options.width + left_;
  const bool empty = is_empty(memory),
             in_order = frame_.pass.fragment != nullptr && frame_.pass.options.fragment->discards;
  if (empty || in_order) {
    for (device::ImageMemory* colour : frame_.target.colours) clear(image(colour), 0);
  }
  if (empty) {
    clear(depth_, frame_.pass.options.farthest());
    return;
  }
  depth_.clear_tiles[number_] = 0;
  for (device::ImageMemory* colour : frame_.target.colours) image(colour).clear_tiles[number_] = 0;
  depths_.fill(frame_.pass.options.farthest());
  if (frame_.pass.fragment == nullptr) {
    draw_depths(memory);
  } else if (in_order) {
    draw_in_order(memory);
  } else {
    draw_seen(memory);
  }
  write_depths();
}

}  // namespace quadgraph::cpu
