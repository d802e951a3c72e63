#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

#include "engine/base/atomic_file.h"
#include "engine/render/picture/metadata.h"
#include "engine/render/picture/picture.h"

namespace quadgraph {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

struct PngWriter {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string error;

  PngWriter() {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) throw std::bad_alloc();
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }

  [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
    static_cast<PngWriter*>(png_get_error_ptr(png))->error = message;
    longjmp(png_jmpbuf(png), 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
};

std::vector<png_text> texts(const Metadata& metadata) {
  std::vector<png_text> all;
  for (const auto& [key, value] : metadata) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = const_cast<char*>(key.c_str());
    text.text = const_cast<char*>(value.c_str());
    text.text_length = value.size();
    all.push_back(text);
  }
  return all;
}

// False on an error of libpng, which leaves by longjmp: nothing with a destructor may live in here.
bool write_all(PngWriter& writer, std::FILE* file, const Picture& picture, const std::vector<std::uint8_t>& rows,
               const png_text* text, int text_count) {
  png_structp png = writer.png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_init_io(png, file);
  const std::size_t row = rows.size() / picture.height;
  png_set_IHDR(png, writer.info, picture.width, picture.height, 8,
               row == std::size_t{4} * picture.width ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_text(png, writer.info, text, text_count);
  png_write_info(png, writer.info);
  for (std::size_t y = 0; y < picture.height; ++y) png_write_row(png, rows.data() + y * row);
  png_write_end(png, writer.info);
  return true;
}

// Threshold in [0, 1) at which a value between two 8-bit codes takes the upper one: spreads the steps of smooth
// gradients evenly, the same in every run (interleaved gradient noise, Jimenez 2014).
float dither(std::size_t x, std::size_t y) {
  const float inner = 0.06711056f * static_cast<float>(x) + 0.00583715f * static_cast<float>(y);
  const float outer = 52.9829189f * (inner - std::floor(inner));
  return outer - std::floor(outer);
}

glm::vec3 at(const std::vector<float>& layer, std::size_t pixel) {
  return {layer[3 * pixel], layer[3 * pixel + 1], layer[3 * pixel + 2]};
}

// Linear display colour of the object in a pixel, premultiplied by alpha.
glm::vec3 object_colour(const Picture& picture, const gpu::ToneTransform& tone, std::size_t pixel) {
  const glm::vec3 radiance(picture.radiance(3 * pixel), picture.radiance(3 * pixel + 1),
                           picture.radiance(3 * pixel + 2));
  if (picture.false_colour) return radiance;
  const float alpha = picture.alpha[pixel];
  return alpha > 0 ? alpha * gpu::tone_mapped(tone, radiance / alpha) : glm::vec3(0);
}

// The share of what is behind that a pixel shows.
glm::vec3 seen_behind(const Picture& picture, std::size_t pixel) {
  return 1.0f - picture.alpha[pixel] + at(picture.transmittance, pixel);
}

std::uint8_t code_of(float shown, float threshold) {
  const float code = 255.0f * srgb_encode(std::clamp(shown, 0.0f, 1.0f));
  return static_cast<std::uint8_t>(std::min(std::floor(code + threshold), 255.0f));
}

}  // namespace

std::vector<std::uint8_t> to_srgb8(const Picture& picture, const ToneOptions& options) {
  const gpu::ToneTransform tone = tone_transform(options, exposure_of(picture, options));
  const bool surrounded = !picture.surroundings.empty() && !options.transparent;
  std::vector<std::uint8_t> bytes(std::size_t{3} * picture.width * picture.height);
  for (std::size_t y = 0; y < picture.height; ++y) {
    const float down = (static_cast<float>(y) + 0.5f) / static_cast<float>(picture.height);
    const glm::vec3 background = options.background_top * (1.0f - down) + options.background_bottom * down;
    for (std::size_t x = 0; x < picture.width; ++x) {
      const std::size_t i = y * picture.width + x;
      const glm::vec3 backdrop = surrounded ? gpu::tone_mapped(tone, at(picture.surroundings, i)) : background;
      const glm::vec3 shown = object_colour(picture, tone, i) + seen_behind(picture, i) * backdrop;
      const float threshold = dither(x, y);
      for (std::size_t c = 0; c < 3; ++c) bytes[3 * i + c] = code_of(shown[static_cast<int>(c)], threshold);
    }
  }
  return bytes;
}

std::vector<std::uint8_t> to_srgba8(const Picture& picture, const ToneOptions& options) {
  const gpu::ToneTransform tone = tone_transform(options, exposure_of(picture, options));
  std::vector<std::uint8_t> bytes(std::size_t{4} * picture.width * picture.height);
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    const glm::vec3 behind = seen_behind(picture, i);
    const float opacity = std::clamp(1.0f - (behind.x + behind.y + behind.z) / 3, 0.0f, 1.0f);
    const float threshold = dither(i % picture.width, i / picture.width);
    const glm::vec3 object = object_colour(picture, tone, i);
    for (std::size_t c = 0; c < 3 && opacity > 0; ++c) {
      bytes[4 * i + c] = code_of(object[static_cast<int>(c)] / opacity, threshold);
    }
    bytes[4 * i + 3] = static_cast<std::uint8_t>(std::lround(255.0f * opacity));
  }
  return bytes;
}

void write_png(const std::filesystem::path& path, const Picture& picture, const ToneOptions& options,
               const Metadata& metadata) {
  const auto rows = options.transparent ? to_srgba8(picture, options) : to_srgb8(picture, options);
  const Metadata all = with_exposure(metadata, picture, options);
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    File file(std::fopen(temporary.c_str(), "wb"), std::fclose);
    if (!file) throw std::runtime_error(std::strerror(errno));
    PngWriter writer;
    const auto text = texts(all);
    if (!write_all(writer, file.get(), picture, rows, text.data(), static_cast<int>(text.size()))) {
      throw std::runtime_error(writer.error);
    }
    if (std::fclose(file.release()) != 0) throw std::runtime_error(std::strerror(errno));
  });
}

}  // namespace quadgraph
