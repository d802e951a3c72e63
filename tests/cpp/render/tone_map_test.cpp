// The screen's tone mapping against that of the picture files.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/render/picture/picture.h"
#include "engine/render/picture/tone_mapper.h"
#include "tests/cpp/fixtures/checked_context.h"

using namespace quadgraph;

namespace {

// Radiance over six decades, negative scattered light, edges of partial coverage, parts that are seen through.
Picture sample_picture(std::uint32_t width, std::uint32_t height) {
  Picture picture{.width = width,
                  .height = height,
                  .scattered = {},
                  .specular = {},
                  .unscattered = {},
                  .transmittance = {},
                  .alpha = {}};
  for (std::uint32_t i = 0; i < width * height; ++i) {
    const float alpha = i % 7 == 0 ? 0.0f : i % 7 == 1 ? 0.25f : 1.0f;
    const float strength = std::pow(10.0f, -6.0f + 6.0f * static_cast<float>(i) / static_cast<float>(width * height));
    for (std::uint32_t c = 0; c < 3; ++c) {
      picture.scattered.push_back(alpha * strength * (i % 11 == 0 ? -0.1f : 1.0f + 0.3f * static_cast<float>(c)));
      picture.specular.push_back(alpha * 0.1f * strength);
      picture.unscattered.push_back(alpha * (i % 3 == 0 ? 0.2f * strength : 0.0f));
      picture.transmittance.push_back(i % 5 == 0 ? 0.3f * alpha : 0.0f);
    }
    picture.alpha.push_back(alpha);
  }
  return picture;
}

PictureBuffers on_device(device::Device& context, const Picture& picture) {
  PictureBuffers buffers;
  buffers.resize(context, picture.width, picture.height);
  const auto write = [&](const device::Buffer& buffer, const std::vector<float>& values) {
    device::write_bytes(context, buffer, std::as_bytes(std::span(values)));
  };
  write(buffers.layers[0], picture.scattered);
  write(buffers.layers[1], picture.specular);
  write(buffers.layers[2], picture.unscattered);
  write(buffers.layers[3], picture.transmittance);
  write(buffers.alpha, picture.alpha);
  buffers.has_surroundings = !picture.surroundings.empty();
  if (buffers.has_surroundings) {
    buffers.make_room_around(context);
    write(buffers.around, picture.surroundings);
  }
  return buffers;
}

}  // namespace

TEST_CASE("the screen shows what a PNG holds, within one code") {
  CheckedContext checked;
  Picture picture = sample_picture(61, 37);
  ToneMapper mapper(checked.context);
  for (const ToneOptions& options :
       {ToneOptions{}, ToneOptions{.exposure_stops = 3.5f}, ToneOptions{.curve = ToneCurve::aces},
        ToneOptions{.curve = ToneCurve::linear, .white_balance = 3000},
        ToneOptions{.exposure_stops = 2.0f, .curve = ToneCurve::agx, .white_balance = 9000},
        ToneOptions{.background_top = glm::vec3(1), .background_bottom = glm::vec3(0.2f)}, ToneOptions{}}) {
    // In the last two the body is seen before its surroundings.
    if (options.background_top.x == 1) {
      for (const float value : picture.specular) picture.surroundings.push_back(3 * value + 1e-3f);
    }
    const PictureBuffers buffers = on_device(checked.context, picture);
    const float stops = mapper.exposure(buffers, options);
    CHECK(std::abs(stops - exposure_of(picture, options)) <= 1.0f / 128);
    ToneOptions same = options;
    same.exposure_stops = stops;
    const auto expected = to_srgb8(picture, same);
    for (const bool blue_first : {false, true}) {
      const auto shown = device::download<std::uint8_t>(
          checked.context, mapper.run(buffers, options, stops, {picture.width, picture.height, blue_first}));
      int worst = 0;
      for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
        CHECK(shown[4 * i + 3] == 255);
        for (std::size_t c = 0; c < 3; ++c) {
          const std::size_t channel = blue_first ? 2 - c : c;
          worst = std::max(worst, std::abs(int{shown[4 * i + channel]} - int{expected[3 * i + c]}));
        }
      }
      CHECK(worst <= 1);
    }
  }
}

TEST_CASE("a picture in motion is stretched over the screen: what is even stays even, and edges stay where they are") {
  CheckedContext checked;
  Picture picture = sample_picture(8, 4);
  for (std::size_t i = 0; i < picture.alpha.size(); ++i) {
    picture.alpha[i] = i % 8 < 4 ? 1.0f : 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      picture.scattered[3 * i + c] = i % 8 < 4 ? 0.4f : 0.0f;
      picture.specular[3 * i + c] = picture.unscattered[3 * i + c] = picture.transmittance[3 * i + c] = 0;
    }
  }
  ToneMapper mapper(checked.context);
  const ToneOptions black{.exposure_stops = 0.0f,
                          .background_top = glm::vec3(0),
                          .background_bottom = glm::vec3(0),
                          .curve = ToneCurve::aces};
  const auto shown = device::download<std::uint32_t>(
      checked.context, mapper.run(on_device(checked.context, picture), black, 0, {32, 16}));
  const float lit = 255 * srgb_encode(gpu::aces_curve(0.4f));
  for (std::size_t y = 0; y < 16; ++y) {
    for (std::size_t x = 0; x < 32; ++x) {
      const auto green = static_cast<float>(shown[32 * y + x] >> 8 & 255u);
      if (x < 14) CHECK(std::abs(green - lit) <= 1);
      if (x >= 18) CHECK(green == 0);
    }
  }
}
