#include "engine/cpu/tile.h"

#include <algorithm>

namespace quadgraph::cpu {
namespace {

constexpr std::uint32_t fragments_at_once = 256;  // of a call of the fragment shader

std::int64_t first_pixel(std::int64_t at) {
  return (at - pixel / 2 + pixel - 1) >> 8;
}
std::int64_t last_pixel(std::int64_t at) {
  return (at - pixel / 2) >> 8;
}
std::int64_t centre(std::int64_t of_pixel) {
  return of_pixel * pixel + pixel / 2;
}

// Values of one fragment: `b` are weights in the window, which add up to 1.
void interpolate(const Triangle& t, const std::array<double, 3>& b, std::uint32_t floats, std::uint32_t flat,
                 float* result) {
  std::array<float, 3> weight;
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += b[k] * t.inverse_w[k];
  for (int k = 0; k < 3; ++k) weight[k] = static_cast<float>(b[k] * t.inverse_w[k] / sum);
  for (std::uint32_t first = 0; first < floats; first += 4) {
    if ((flat >> (first / 4) & 1u) != 0) {
      std::copy_n(t.flat + first, 4, result + first);
      continue;
    }
    for (std::uint32_t k = first; k < first + 4; ++k) {
      result[k] = weight[0] * t.values[0][k] + weight[1] * t.values[1][k] + weight[2] * t.values[2][k];
    }
  }
}

}  // namespace

Edges::Edges(const Triangle& t) {
  for (int k = 0; k < 3; ++k) {
    const int from = (k + 1) % 3, to = (k + 2) % 3;
    x_[k] = t.x[from];
    y_[k] = t.y[from];
    dx_[k] = t.x[to] - t.x[from];
    dy_[k] = t.y[to] - t.y[from];
    least_[k] = (dy_[k] > 0 || (dy_[k] == 0 && dx_[k] < 0)) ? 0 : 1;
  }
  twice_ = dx_[2] * dy_[1] - dx_[1] * dy_[2];
}

void Batch::take(const Triangle& t, const Edges& edges, std::uint64_t place, const std::array<double, 3>& weights) {
  const std::uint32_t floats = frame_.floats(), flat = frame_.pass.options.vertex->flat;
  const std::size_t end = inputs_.size();
  pixels_.push_back(place);
  inputs_.resize(end + floats);
  interpolate(t, weights, floats, flat, inputs_.data() + end);
  if ((frame_.pass.options.fragment->derivatives >> frame_.pass.options.variant & 1u) == 0) return;
  std::array<double, 3> right = weights, below = weights;
  for (int k = 0; k < 3; ++k) {
    right[k] += edges.inverse() * static_cast<double>(edges.to_right(k));
    below[k] += edges.inverse() * static_cast<double>(edges.to_below(k));
  }
  right_.resize(end + floats);
  below_.resize(end + floats);
  interpolate(t, right, floats, flat, right_.data() + end);
  interpolate(t, below, floats, flat, below_.data() + end);
}

template <typename Keep>
void Batch::shade(const Keep& keep) {
  if (pixels_.empty()) return;
  const std::size_t images = frame_.target.colours.size();
  colours_.resize(4 * images * count());
  if (kept_.size() < count()) kept_ = std::vector<char>(count());
  frame_.pass.fragment(frame_.push, front_, inputs_.data(), right_.data(), below_.data(), count(), colours_.data(),
                       reinterpret_cast<bool*>(kept_.data()), frame_.pass.options.variant);
  for (std::uint32_t k = 0; k < count(); ++k) {
    if (kept_[k] == 0) continue;
    for (std::size_t image = 0; image < images; ++image) {
      auto& memory = static_cast<ImageMemory&>(*frame_.target.colours[image]);
      std::copy_n(colours_.data() + 4 * (images * k + image), 4, memory.texels() + 4 * pixels_[k]);
    }
    keep(k);
  }
  pixels_.clear();
  for (std::vector<float>* values : {&inputs_, &right_, &below_}) values->clear();
}

Tile::Tile(const Frame& frame, std::uint32_t x, std::uint32_t y)
    : frame_(frame),
      depth_(static_cast<ImageMemory&>(*frame.target.depth)),
      left_(x),
      top_(y),
      right_(std::min(x + tile_side, frame.target.width)),
      bottom_(std::min(y + tile_side, frame.target.height)),
      waits_(frame.pass.fragment != nullptr && !frame.pass.options.fragment->discards),
      front_(frame, true),
      back_(frame, false) {
  if (waits_) seen_.fill(nullptr);
}

void Tile::clear() {
  for (std::uint32_t y = top_; y < bottom_; ++y) {
    std::fill_n(depth_.texels() + place(left_, y), right_ - left_, 1.0f);
    for (device::ImageMemory* image : frame_.target.colours) {
      std::fill_n(static_cast<ImageMemory&>(*image).texels() + 4 * place(left_, y), 4 * (right_ - left_), 0.0f);
    }
  }
}

void Tile::draw(const Triangle& t) {
  const auto [least_x, most_x] = std::minmax({t.x[0], t.x[1], t.x[2]});
  const auto [least_y, most_y] = std::minmax({t.y[0], t.y[1], t.y[2]});
  const std::int64_t x0 = std::max<std::int64_t>(left_, first_pixel(least_x));
  const std::int64_t y0 = std::max<std::int64_t>(top_, first_pixel(least_y));
  const std::int64_t x1 = std::min<std::int64_t>(right_, last_pixel(most_x) + 1);
  const std::int64_t y1 = std::min<std::int64_t>(bottom_, last_pixel(most_y) + 1);
  if (x0 >= x1 || y0 >= y1) return;
  const Edges edges(t);
  double inverse = 0;  // once it is needed: small triangles may cover no pixel
  for (std::int64_t y = y0; y < y1; ++y) {
    std::array<std::int64_t, 3> e;
    for (int k = 0; k < 3; ++k) e[k] = edges.at(k, centre(x0), centre(y));
    for (std::int64_t x = x0; x < x1; ++x) {
      if (e[0] >= edges.least(0) && e[1] >= edges.least(1) && e[2] >= edges.least(2)) {
        if (inverse == 0) inverse = edges.inverse();
        cover(t, edges, x, y,
              {inverse * static_cast<double>(e[0]), inverse * static_cast<double>(e[1]),
               inverse * static_cast<double>(e[2])});
      }
      for (int k = 0; k < 3; ++k) e[k] += edges.to_right(k);
    }
  }
  if (waits_) return;
  const auto keep = [&](Batch& batch) {
    batch.shade([&](std::uint32_t k) { depth_.texels()[batch.pixel_of(k)] = depths_[k]; });
    depths_.clear();
  };
  if (frame_.pass.fragment != nullptr) keep(t.front ? front_ : back_);
}

void Tile::cover(const Triangle& t, const Edges& edges, std::int64_t x, std::int64_t y,
                 const std::array<double, 3>& weights) {
  const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
  float& depth = depth_.texels()[place(column, row)];
  const auto z = static_cast<float>(weights[0] * t.z[0] + weights[1] * t.z[1] + weights[2] * t.z[2]);
  if (!(z < depth)) return;
  if (frame_.pass.fragment != nullptr && !waits_) {
    (t.front ? front_ : back_).take(t, edges, place(column, row), weights);
    depths_.push_back(z);
    return;
  }
  depth = z;
  if (waits_) seen_[(row - top_) * tile_side + column - left_] = &t;
}

void Tile::finish() {
  if (!waits_) return;
  const auto shade = [](Batch& batch) { batch.shade([](std::uint32_t) {}); };
  const Triangle* last = nullptr;
  Edges edges;
  double inverse = 0;
  for (std::uint32_t y = top_; y < bottom_; ++y) {
    for (std::uint32_t x = left_; x < right_; ++x) {
      const Triangle* t = seen_[(y - top_) * tile_side + x - left_];
      if (t == nullptr) continue;
      if (t != last) {
        edges = Edges(*t);
        inverse = edges.inverse();
        last = t;
      }
      std::array<double, 3> weights;
      for (int k = 0; k < 3; ++k) weights[k] = inverse * static_cast<double>(edges.at(k, centre(x), centre(y)));
      Batch& batch = t->front ? front_ : back_;
      batch.take(*t, edges, place(x, y), weights);
      if (batch.count() == fragments_at_once) shade(batch);
    }
  }
  shade(front_);
  shade(back_);
}

}  // namespace quadgraph::cpu
