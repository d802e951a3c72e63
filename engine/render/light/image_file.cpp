#include "engine/render/light/image_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <glm/common.hpp>

#include "engine/base/error.h"
#include "engine/base/regular_file.h"
#include "engine/base/text.h"
#include "engine/file/file_cache.h"
#include "engine/render/light/lights.h"

namespace quadgraph {
namespace {

constexpr std::int64_t largest_side = 16384;  // texels
// Texels of any file, and for each of its bytes: others are made to fill memory.
constexpr std::int64_t free_texels = 50000000, texels_a_byte = 16;

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return extension;
}

void check_values(const std::filesystem::path& path, Image& image) {
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    glm::vec3& texel = image.texels[i];
    for (int c = 0; c < 3; ++c) {
      if (std::abs(texel[c]) <= largest_power) continue;
      throw InputError(path.string() + ": texel (" + std::to_string(i % image.width) + ", " +
                       std::to_string(i / image.width) + "): found " + number_text(texel[c]) +
                       ", allowed are finite numbers up to " + number_text(largest_power));
    }
    texel = glm::max(texel, glm::vec3(0));
  }
}

// Reads a channel of `file` into component c of every texel.
void add_slice(Imf::FrameBuffer& frame, const std::string& name, Image& image, const Imath::Box2i& window,
               std::size_t c) {
  constexpr std::size_t step = sizeof(glm::vec3);
  const std::size_t row = step * image.width;
  char* base = reinterpret_cast<char*>(image.texels.data()) + c * sizeof(float);
  base -= window.min.x * static_cast<std::ptrdiff_t>(step) + window.min.y * static_cast<std::ptrdiff_t>(row);
  frame.insert(name.c_str(), Imf::Slice(Imf::FLOAT, base, step, row));
}

// Channels of these names, at most three, as components of every texel; nothing where one of them is not there.
std::optional<Image> read_channels(const std::filesystem::path& path, std::span<const std::string> names) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  check_image_size(path, width, height);
  for (const std::string& name : names) {
    if (file.header().channels().findChannel(name) == nullptr) return std::nullopt;
  }
  Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  image.texels.resize(static_cast<std::size_t>(width * height));
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < names.size(); ++c) add_slice(frame, names[c], image, window, c);
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return image;
}

// Says what is wrong with the file.
std::optional<Image> exr_channels(const std::filesystem::path& path, std::span<const std::string> names) {
  try {
    return read_channels(path, names);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    const std::string what = error.what();  // OpenEXR says nothing of a file that ends within its header
    throw InputError(path.string() + ": " + (what.empty() ? "cannot be read as EXR: cut off" : what));
  }
}

// Linear value of a byte of a PNG, the inverse of srgb_encode (tone_map.h).
float srgb_decode(std::uint8_t value) {
  const float encoded = static_cast<float>(value) / 255;
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

// Of values of `channels` a texel, of which the first three count.
template <typename Value, typename Decode>
Image image_of(const png_image& png, const Value* values, std::size_t channels, const Decode& decode) {
  Image image{png.width, png.height, {}};
  for (std::size_t i = 0; i < std::size_t{png.width} * png.height; ++i, values += channels) {
    image.texels.emplace_back(decode(values[0]), decode(values[1]), decode(values[2]));
  }
  return image;
}

// A PNG whose header has been read, and found to be of a size that is allowed.
class OpenPng {
 public:
  explicit OpenPng(const std::filesystem::path& path) : path_(path) {
    png.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&png, path.c_str()) == 0) fail();
    try {
      check_image_size(path, png.width, png.height);
    } catch (...) {
      png_image_free(&png);
      throw;
    }
  }
  OpenPng(const OpenPng&) = delete;
  OpenPng& operator=(const OpenPng&) = delete;
  ~OpenPng() { png_image_free(&png); }

  std::vector<std::uint8_t> values(std::uint32_t format) {
    png.format = format;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(png));
    const png_color black{};
    if (png_image_finish_read(&png, &black, bytes.data(), 0, nullptr) == 0) fail();
    return bytes;
  }

  png_image png{};

 private:
  [[noreturn]] void fail() {
    const std::string message = png.message;
    png_image_free(&png);
    throw InputError(path_.string() + ": " + message);
  }

  std::filesystem::path path_;
};

}  // namespace

void check_image_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height) {
  const bool sides = width >= 1 && height >= 1 && width <= largest_side && height <= largest_side;
  const auto bytes = static_cast<std::int64_t>(bytes_of_regular_file(path));
  if (sides && width * height > free_texels + texels_a_byte * bytes) {
    throw InputError(path.string() + ": found " + std::to_string(width) + "x" + std::to_string(height) +
                     " texels in a file of " + std::to_string(bytes) + " bytes, allowed are 50 million and " +
                     std::to_string(texels_a_byte) + " for each byte; scale the image down");
  }
  if (sides) return;
  throw InputError(path.string() + ": found " + std::to_string(width) + "x" + std::to_string(height) +
                   " texels, expected 1 to " + std::to_string(largest_side) + " a side");
}

std::optional<Image> read_exr_channels(const std::filesystem::path& path, std::span<const std::string> names) {
  std::optional<Image> image = exr_channels(path, names);
  if (image) check_values(path, *image);
  return image;
}

Image read_exr(const std::filesystem::path& path) {
  if (auto colours = exr_channels(path, std::array<std::string, 3>{"R", "G", "B"})) return *colours;
  auto grey = exr_channels(path, std::array<std::string, 1>{"Y"});
  if (!grey) throw InputError(path.string() + ": no channels R, G and B, and no Y");
  for (glm::vec3& texel : grey->texels) texel = glm::vec3(texel.x);
  return *grey;
}

Image read_png(const std::filesystem::path& path) {
  OpenPng file(path);
  // libpng's own way from sRGB is a power of 2.2.
  const bool linear = (file.png.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  const std::vector<std::uint8_t> bytes = file.values(linear ? PNG_FORMAT_LINEAR_RGB : PNG_FORMAT_RGB);
  return linear ? image_of(file.png, reinterpret_cast<const std::uint16_t*>(bytes.data()), 3,
                           [](std::uint16_t value) { return static_cast<float>(value) / 65535; })
                : image_of(file.png, bytes.data(), 3, srgb_decode);
}

Image read_png_values(const std::filesystem::path& path) {
  if (extension_of(path) != ".png") throw InputError(path.string() + ": expected an image whose name ends in .png");
  bytes_of_regular_file(path);
  OpenPng file(path);
  file.png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // whatever they mean, they are not to be changed
  const std::vector<std::uint8_t> bytes = file.values(PNG_FORMAT_RGBA);
  return image_of(file.png, bytes.data(), 4, [](std::uint8_t value) { return static_cast<float>(value) / 255; });
}

Image read_image(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  const auto read = extension == ".exr"   ? read_exr
                    : extension == ".hdr" ? read_hdr
                    : extension == ".png" ? read_png
                                          : nullptr;
  if (read == nullptr) {
    throw InputError(path.string() + ": expected an image whose name ends in .exr, .hdr or .png");
  }
  bytes_of_regular_file(path);
  Image image = read(path);
  check_values(path, image);
  return image;
}

std::shared_ptr<const ImagePyramid> load_pyramid(const std::filesystem::path& path) {
  static FileCache<ImagePyramid> known(8);
  return known.load(path, [](const std::filesystem::path& file) {
    auto pyramid = std::make_shared<ImagePyramid>(pyramid_of(read_image(file), largest_kept));
    pyramid->file = file;
    return pyramid;
  });
}

}  // namespace quadgraph
