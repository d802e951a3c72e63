// Radiance pictures (G. Ward, "Real Pixels", Graphics Gems II, 1991): text, then rows of bytes R, G, B and a common
// exponent, in runs per component.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/light/image_file.h"

namespace quadgraph {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
    if (!file) throw error("cannot be read");
  }

  InputError error(const std::string& what) const { return InputError(path_.string() + ": " + what); }

  std::string_view line() {
    const std::string_view rest = std::string_view(bytes_).substr(at_);
    const auto end = rest.find('\n');
    if (end == std::string_view::npos) throw error("the header does not end");
    at_ += end + 1;
    return rest.substr(0, end);
  }

  std::uint8_t byte() {
    if (at_ >= bytes_.size()) throw error("ends after " + std::to_string(bytes_.size()) + " bytes, in its texels");
    return static_cast<std::uint8_t>(bytes_[at_++]);
  }

  Rgbe rgbe() { return {byte(), byte(), byte(), byte()}; }

  // What a row of runs begins with; read only if it is there.
  bool begins_runs(std::uint32_t width) {
    if (width < 8 || width > 32767 || at_ + 4 > bytes_.size()) return false;
    const auto value = [&](std::size_t i) { return static_cast<std::uint8_t>(bytes_[at_ + i]); };
    if (value(0) != 2 || value(1) != 2 || (value(2) << 8 | value(3)) != static_cast<int>(width)) return false;
    at_ += 4;
    return true;
  }

 private:
  std::filesystem::path path_;
  std::string bytes_;
  std::size_t at_ = 0;
};

void check_header(Reader& reader) {
  if (!reader.line().starts_with("#?")) throw reader.error("not a Radiance picture: it does not begin with #?");
  for (std::string_view line = reader.line(); !line.empty() && line != "\r"; line = reader.line()) {
    if (line.starts_with("FORMAT=") && !line.starts_with("FORMAT=32-bit_rle_rgbe")) {
      throw reader.error("found '" + std::string(line) + "', expected FORMAT=32-bit_rle_rgbe");
    }
  }
}

// Reads the line "-Y height +X width".
std::array<std::uint32_t, 2> read_size(Reader& reader, const std::filesystem::path& path) {
  const std::string text(reader.line());
  const auto words = split(text, ' ');
  if (words.size() != 4 || words[0] != "-Y" || words[2] != "+X") {
    throw reader.error("found '" + text + "', expected -Y HEIGHT +X WIDTH");
  }
  const auto side = [&](std::string_view word) {
    if (word.ends_with('\r')) word.remove_suffix(1);
    return static_cast<std::int64_t>(parse_number(word, path.string() + ", size"));
  };
  const std::int64_t height = side(words[1]), width = side(words[3]);
  check_image_size(path, width, height);
  return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

// One component of a row: runs of one value (128 + count, value) and of several (count, values).
void read_runs(Reader& reader, std::size_t component, std::vector<Rgbe>& row) {
  for (std::size_t x = 0; x < row.size();) {
    const std::uint8_t code = reader.byte();
    const std::size_t count = code > 128 ? code - 128u : code;
    if (count == 0 || x + count > row.size()) throw reader.error("a run of texels does not fit into its row");
    const std::uint8_t value = code > 128 ? reader.byte() : std::uint8_t{0};
    for (std::size_t k = 0; k < count; ++k) row[x++][component] = code > 128 ? value : reader.byte();
  }
}

// A row without runs by component; (1, 1, 1, count) repeats the texel before.
void read_texels(Reader& reader, std::vector<Rgbe>& row) {
  int shift = 0;
  for (std::size_t x = 0; x < row.size();) {
    const Rgbe texel = reader.rgbe();
    if (texel[0] != 1 || texel[1] != 1 || texel[2] != 1) {
      row[x++] = texel;
      shift = 0;
      continue;
    }
    const std::size_t count = static_cast<std::size_t>(texel[3]) << shift;
    if (x == 0 || shift > 16 || count > row.size() - x) throw reader.error("a run of texels does not fit into its row");
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
    x += count;
    shift += 8;
  }
}

glm::vec3 linear(const Rgbe& texel) {
  if (texel[3] == 0) return glm::vec3(0);
  return std::ldexp(1.0f, texel[3] - 136) * (glm::vec3(texel[0], texel[1], texel[2]) + 0.5f);
}

}  // namespace

Image read_hdr(const std::filesystem::path& path) {
  Reader reader(path);
  check_header(reader);
  const auto [width, height] = read_size(reader, path);
  Image image{width, height, {}};
  std::vector<Rgbe> row(width);
  for (std::uint32_t y = 0; y < height; ++y) {
    if (reader.begins_runs(width)) {
      for (std::size_t component = 0; component < 4; ++component) read_runs(reader, component, row);
    } else {
      read_texels(reader, row);
    }
    for (const Rgbe& texel : row) image.texels.push_back(linear(texel));
  }
  return image;
}

}  // namespace quadgraph
