// Tone curve and picture files.
#include "engine/render/picture/picture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <doctest/doctest.h>
#include <png.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "engine/base/error.h"

using namespace quadgraph;

namespace {

// An empty directory that vanishes with the test.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("quadgraph_picture_" + std::to_string(getpid()));

  Folder() { std::filesystem::create_directories(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }

  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path), {}));
  }
};

// Every value of a layer different, some scattered ones negative; the last column is not covered.
Picture sample_picture() {
  Picture picture{
      .width = 5, .height = 3, .scattered = {}, .specular = {}, .unscattered = {}, .transmittance = {}, .alpha = {}};
  for (int i = 0; i < 15; ++i) {
    const bool covered = i % 5 != 4;
    for (int c = 0; c < 3; ++c) {
      picture.scattered.push_back(covered ? 0.01f * static_cast<float>(3 * i + c) - 0.02f : 0.0f);
      picture.specular.push_back(covered ? 1e-4f * static_cast<float>(i * i + c) : 0.0f);
      picture.unscattered.push_back(covered ? 1e-5f * static_cast<float>(i + 5 * c) : 0.0f);
      picture.transmittance.push_back(covered ? 0.01f * static_cast<float>(i + c) : 0.0f);
    }
    picture.alpha.push_back(covered ? 1.0f : 0.0f);
  }
  return picture;
}

const Metadata metadata = {{"material", "marble"}, {"units", "W/(mm^2 sr)"}, {"energy balance", "1e-7/0/2e-7"}};

std::vector<float> read_channel(Imf::InputFile& file, const std::string& name, std::size_t width, std::size_t height) {
  const Imf::Channel* channel = file.header().channels().findChannel(name);
  REQUIRE(channel != nullptr);
  CHECK(channel->type == Imf::FLOAT);
  std::vector<float> values(width * height);
  Imf::FrameBuffer frame;
  frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 4 * width));
  file.setFrameBuffer(frame);
  file.readPixels(0, static_cast<int>(height) - 1);
  return values;
}

}  // namespace

TEST_CASE("the sRGB code of a linear value") {
  CHECK(srgb_encode(0) == 0);
  CHECK(srgb_encode(1) == doctest::Approx(1));
  CHECK(srgb_encode(0.002f) == doctest::Approx(0.02584));
  CHECK(srgb_encode(0.2140411f) == doctest::Approx(0.5).epsilon(1e-4));
}

TEST_CASE("automatic exposure follows the light, so that the shown picture does not change with it") {
  Picture picture = sample_picture();
  const auto shown = to_srgb8(picture, {});
  const float stops = auto_exposure(picture, {});
  for (auto* layer : {&picture.scattered, &picture.specular, &picture.unscattered}) {
    for (float& value : *layer) value *= 8;
  }
  CHECK(auto_exposure(picture, {}) == doctest::Approx(stops - 3));
  CHECK(to_srgb8(picture, {}) == shown);
  CHECK(to_srgb8(picture, {.exposure_stops = stops - 4}) != shown);
}

TEST_CASE("automatic exposure keeps what is of one colour from clipping") {
  const auto of = [](const glm::vec3& colour) {
    Picture picture = sample_picture();
    for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
      picture.alpha[i] = 1;
      for (std::size_t c = 0; c < 3; ++c) {
        picture.scattered[3 * i + c] = colour[static_cast<int>(c)];
        picture.specular[3 * i + c] = picture.unscattered[3 * i + c] = 0;
      }
    }
    return auto_exposure(picture, {.curve = ToneCurve::aces});
  };
  CHECK(of(glm::vec3(0.5f)) == doctest::Approx(std::log2(exposure_target(ToneCurve::aces).luminance / 0.5)));
  const double warm = 0.2126 + 0.7 * 0.7152 + 0.5 * 0.0722;
  CHECK(of({1, 0.7f, 0.5f}) == doctest::Approx(std::log2(exposure_target(ToneCurve::aces).luminance / warm)));
  CHECK(of({2, 0.01f, 0.01f}) == doctest::Approx(std::log2(exposure_target(ToneCurve::aces).brightest / 2)));
}

TEST_CASE("a picture with straight alpha, laid over black, is the picture on black but for rounding") {
  const Picture picture = sample_picture();
  const ToneOptions black{.exposure_stops = 0.0f, .background_top = glm::vec3(0), .background_bottom = glm::vec3(0)};
  const auto opaque = to_srgb8(picture, black), clear = to_srgba8(picture, black);
  REQUIRE(clear.size() == picture.alpha.size() * 4);
  const auto decoded = [](std::uint8_t code) {
    const double share = code / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  };
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double laid = decoded(clear[4 * i + c]) * clear[4 * i + 3] / 255.0;
      CHECK(laid == doctest::Approx(decoded(opaque[3 * i + c])).epsilon(0.02).scale(1));
    }
  }
}

TEST_CASE("a black picture is shown black on its background, which is seen through it as it lets light through") {
  Picture picture = sample_picture();
  for (auto* layer : {&picture.scattered, &picture.specular, &picture.unscattered}) layer->assign(layer->size(), 0);
  CHECK(auto_exposure(picture, {}) == 0);
  const ToneOptions white{.background_top = glm::vec3(1), .background_bottom = glm::vec3(1)};
  const auto seen = to_srgb8(picture, white);
  for (std::size_t value = 0; value < seen.size(); ++value) {
    const bool covered = value / 3 % 5 != 4;
    const float through = 255 * srgb_encode(covered ? picture.transmittance[value] : 1.0f);
    CHECK(std::abs(static_cast<float>(seen[value]) - through) <= 1);
  }
  picture.transmittance.assign(picture.transmittance.size(), 0);
  const auto bytes = to_srgb8(picture, white);
  for (std::size_t value = 0; value < bytes.size(); ++value) CHECK(bytes[value] == (value / 3 % 5 == 4 ? 255 : 0));
}

TEST_CASE("a PNG reads back as what is shown, with its metadata") {
  const Folder folder;
  const auto path = folder.path / "picture.png";
  const Picture picture = sample_picture();
  write_png(path, picture, {}, metadata);
  CHECK(folder.file_count() == 1);

  std::FILE* file = std::fopen(path.c_str(), "rb");
  REQUIRE(file != nullptr);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  REQUIRE(png_get_image_width(png, info) == 5);
  REQUIRE(png_get_image_height(png, info) == 3);
  CHECK(png_get_bit_depth(png, info) == 8);
  CHECK(png_get_valid(png, info, PNG_INFO_sRGB) != 0);
  const auto expected = to_srgb8(picture, {});
  for (std::size_t y = 0; y < 3; ++y) {
    const png_bytep row = png_get_rows(png, info)[y];
    CHECK(std::equal(row, row + 15, expected.begin() + static_cast<std::ptrdiff_t>(15 * y)));
  }
  png_textp text = nullptr;
  int count = 0;
  png_get_text(png, info, &text, &count);
  std::map<std::string, std::string> found;
  for (int i = 0; i < count; ++i) found[text[i].key] = text[i].text;
  for (const auto& [key, value] : metadata) CHECK(found[key] == value);
  CHECK(std::stof(found["exposure"]) == doctest::Approx(auto_exposure(picture, {})));
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(file);
}

TEST_CASE("an EXR keeps the layers, their sum, negative values and its attributes") {
  const Folder folder;
  const auto path = folder.path / "picture.exr";
  const Picture picture = sample_picture();
  write_exr(path, picture, {}, metadata);
  CHECK(folder.file_count() == 1);

  Imf::InputFile file(path.c_str());
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string channel(1, "RGB"[c]);
    const auto sum = read_channel(file, channel, 5, 3);
    const auto scattered = read_channel(file, "scattered." + channel, 5, 3);
    const auto specular = read_channel(file, "specular." + channel, 5, 3);
    const auto unscattered = read_channel(file, "unscattered." + channel, 5, 3);
    const auto transmittance = read_channel(file, "transmittance." + channel, 5, 3);
    for (std::size_t i = 0; i < 15; ++i) {
      CHECK(scattered[i] == picture.scattered[3 * i + c]);
      CHECK(specular[i] == picture.specular[3 * i + c]);
      CHECK(unscattered[i] == picture.unscattered[3 * i + c]);
      CHECK(transmittance[i] == picture.transmittance[3 * i + c]);
      CHECK(sum[i] == scattered[i] + specular[i] + unscattered[i]);
    }
  }
  CHECK(read_channel(file, "A", 5, 3) == picture.alpha);
  for (const auto& [key, value] : metadata) {
    const auto* attribute = file.header().findTypedAttribute<Imf::StringAttribute>(key);
    REQUIRE(attribute != nullptr);
    CHECK(attribute->value() == value);
  }
  CHECK(file.header().findTypedAttribute<Imf::StringAttribute>("exposure") != nullptr);
}

TEST_CASE("a picture that cannot be written leaves nothing and names the file") {
  const Folder folder;
  const auto missing = folder.path / "no such folder";
  CHECK_THROWS_WITH_AS(write_png(missing / "a.png", sample_picture(), {}, {}), doctest::Contains("a.png"), InputError);
  CHECK_THROWS_WITH_AS(write_exr(missing / "a.exr", sample_picture(), {}, {}), doctest::Contains("a.exr"), InputError);
  // A directory in the way: the temporary file must not stay behind.
  std::filesystem::create_directories(folder.path / "b.png" / "full");
  CHECK_THROWS_AS(write_png(folder.path / "b.png", sample_picture(), {}, {}), InputError);
  CHECK(folder.file_count() == 1);
}
