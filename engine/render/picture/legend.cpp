#include "engine/render/picture/legend.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shaders/display/colour_map.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace quadgraph {
namespace {

constexpr float letter = 0.62f;  // linear grey of the text

std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", std::abs(value) < 1e-12 ? 0.0 : value);
  return text;
}

// 1, 2 or 5 times a power of ten, at most a quarter of the range.
double round_step(double range) {
  const double most = range / 4, power = std::pow(10, std::floor(std::log10(most)));
  return power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
}

// Only letters that the font has.
std::string plain(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) {
      result += text[i];
    } else if (text.compare(i, 2, "²") == 0) {
      result += "^2";
    } else if (text.compare(i, 2, "φ") == 0) {
      result += "phi";
    }
  }
  return result;
}

class Canvas {
 public:
  explicit Canvas(Picture& picture) : picture_(picture) {}

  void fill(int x, int y, int width, int height, const glm::vec3& colour) {
    for (int row = std::max(y, 0); row < std::min(y + height, static_cast<int>(picture_.height)); ++row) {
      for (int column = std::max(x, 0); column < std::min(x + width, static_cast<int>(picture_.width)); ++column) {
        set(static_cast<std::size_t>(row) * picture_.width + static_cast<std::size_t>(column), colour);
      }
    }
  }

  // Three quarters of what is there is taken away.
  void darken(int x, int y, int width, int height) {
    for (int row = std::max(y, 0); row < std::min(y + height, static_cast<int>(picture_.height)); ++row) {
      for (int column = std::max(x, 0); column < std::min(x + width, static_cast<int>(picture_.width)); ++column) {
        const auto pixel = static_cast<std::size_t>(row) * picture_.width + static_cast<std::size_t>(column);
        for (std::size_t c = 0; c < 3; ++c) picture_.scattered[3 * pixel + c] *= 0.25f;
        picture_.alpha[pixel] = 1 - 0.25f * (1 - picture_.alpha[pixel]);
      }
    }
  }

  // From its upper left corner; every dot of the font is `size` pixels wide.
  void write(int x, int y, int size, const std::string& text) {
    std::vector<float> quads(text.size() * 80 * 16);
    std::string letters = plain(text);
    const int count = stb_easy_font_print(0, 0, letters.data(), nullptr, quads.data(),
                                          static_cast<int>(quads.size() * sizeof(float)));
    for (int i = 0; i < count; ++i) {
      const float* quad = quads.data() + 16 * i;  // four corners of x, y, z and a colour
      const auto at = [&](int k) { return static_cast<int>(std::lround(static_cast<double>(quad[k]))); };
      fill(x + size * at(0), y + size * at(1), size * (at(8) - at(0)), size * (at(9) - at(1)), glm::vec3(letter));
    }
  }

  static int width_of(const std::string& text, int size) {
    std::string letters = plain(text);
    return size * stb_easy_font_width(letters.data());
  }

 private:
  void set(std::size_t pixel, const glm::vec3& colour) {
    for (std::size_t c = 0; c < 3; ++c) {
      picture_.scattered[3 * pixel + c] = colour[static_cast<int>(c)];
      picture_.specular[3 * pixel + c] = picture_.unscattered[3 * pixel + c] = 0;
      picture_.transmittance[3 * pixel + c] = 0;
    }
    picture_.alpha[pixel] = 1;
  }

  Picture& picture_;
};

}  // namespace

std::vector<Tick> ticks_of(const Legend& legend) {
  std::vector<Tick> ticks;
  const auto add = [&](double value) { ticks.push_back({legend.place(value), short_text(value)}); };
  if (!(legend.high > legend.low)) return ticks;
  if (legend.logarithmic) {
    for (double power = std::pow(10, std::ceil(std::log10(legend.low) - 1e-9)); power <= 1.0001 * legend.high;
         power *= 10) {
      add(power);
    }
    return ticks;
  }
  const double step = round_step(legend.high - legend.low);
  for (double i = std::ceil(legend.low / step - 1e-9); i * step <= legend.high * (1 + 1e-9); ++i) add(i * step);
  return ticks;
}

void draw_legend(Picture& picture, const Legend& legend) {
  const int width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
  const int size = std::max(1, std::min(width, height) / 400);
  const int margin = 12 * size, bar_width = std::min(width - 2 * margin, 240 * size), bar_height = 8 * size;
  if (bar_width < 60 * size || height < 80 * size) return;
  Canvas canvas(picture);
  const int left = margin, top = height - margin - bar_height - 14 * size;
  const std::string title = legend.title + ", " + legend.unit;
  const int wide = std::max(bar_width, Canvas::width_of(title, size));
  canvas.darken(left - 6 * size, top - 18 * size, wide + 12 * size, height - top + 12 * size);
  canvas.write(left, top - 12 * size, size, title);
  for (int x = 0; x < bar_width; ++x) {
    const float t = (static_cast<float>(x) + 0.5f) / static_cast<float>(bar_width);
    canvas.fill(left + x, top, 1, bar_height, gpu::mapped_colour(t, legend.diverging ? 1 : 0));
  }
  for (const Tick& tick : ticks_of(legend)) {
    const int x = left + static_cast<int>(tick.place * static_cast<float>(bar_width - 1));
    canvas.fill(x, top + bar_height, size, 3 * size, glm::vec3(letter));
    canvas.write(x - (tick.place > 0.04f ? Canvas::width_of(tick.text, size) / 2 : 0), top + bar_height + 5 * size,
                 size, tick.text);
  }
}

}  // namespace quadgraph
