#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "engine/base/atomic_file.h"
#include "engine/render/picture/metadata.h"
#include "engine/render/picture/picture.h"

namespace quadgraph {
namespace {

// Adds three channels "<prefix>R" .. "<prefix>B" that lie interleaved in `rgb`.
void add_rgb(Imf::Header& header, Imf::FrameBuffer& frame, const std::string& prefix, std::vector<float>& rgb,
             std::size_t width) {
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name = prefix + "RGB"[c];
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(rgb.data() + c), 3 * sizeof(float),
                                  3 * sizeof(float) * width));
  }
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Picture& picture, const ToneOptions& options,
               const Metadata& metadata) {
  Imf::Header header(static_cast<int>(picture.width), static_cast<int>(picture.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [key, value] : with_exposure(metadata, picture, options))
    header.insert(key, Imf::StringAttribute(value));

  // OpenEXR's frame buffer wants non-const memory for reading and writing alike.
  Picture layers = picture;
  std::vector<float>& alpha = layers.alpha;
  std::vector<float> sum(layers.scattered.size());
  for (std::size_t i = 0; i < sum.size(); ++i)
    sum[i] = layers.scattered[i] + layers.specular[i] + layers.unscattered[i];
  Imf::FrameBuffer frame;
  add_rgb(header, frame, "", sum, picture.width);
  add_rgb(header, frame, "scattered.", layers.scattered, picture.width);
  add_rgb(header, frame, "specular.", layers.specular, picture.width);
  add_rgb(header, frame, "unscattered.", layers.unscattered, picture.width);
  add_rgb(header, frame, "transmittance.", layers.transmittance, picture.width);
  if (!layers.surroundings.empty()) add_rgb(header, frame, "surroundings.", layers.surroundings, picture.width);
  if (!layers.standard_error.empty()) add_rgb(header, frame, "standard_error.", layers.standard_error, picture.width);
  header.channels().insert("A", Imf::Channel(Imf::FLOAT));
  frame.insert(
      "A", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(alpha.data()), sizeof(float), sizeof(float) * picture.width));

  write_atomically(path, [&](const std::filesystem::path& temporary) {
    Imf::OutputFile file(temporary.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(static_cast<int>(picture.height));
  });
}

}  // namespace quadgraph
