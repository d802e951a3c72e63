// Vectors in a layout.
#include <bit>

#include "tools/layouts/factors.h"

namespace quadgraph::layouts {
namespace {

using Words = std::vector<std::uint32_t>;

std::uint32_t word(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

// The channels of phi, then of phi2.
std::vector<double> values_of(const Field& field, Model model) {
  std::vector<double> values = {field.phi.x, field.phi.y, field.phi.z};
  if (model == Model::sp3) values.insert(values.end(), {field.phi2.x, field.phi2.y, field.phi2.z});
  return values;
}

std::size_t words_per_field(Model model, int vectors) {
  const std::size_t moments = model == Model::sp3 ? 2 : 1;
  if (vectors == VECTORS_HALF) return moments == 2 ? 3 : 2;
  return moments * (vectors == VECTORS_WIDE ? 4 : 3);
}

// Where value k of field i lies, in words.
std::size_t place(std::size_t i, std::size_t k, std::size_t count, Model model, int vectors) {
  if (vectors == VECTORS_PLANES) return k * count + i;
  const std::size_t wide = vectors == VECTORS_WIDE ? k / 3 : 0;
  return i * words_per_field(model, vectors) + k + wide;
}

}  // namespace

std::uint64_t field_bytes(Model model, int vectors) {
  return words_per_field(model, vectors) * sizeof(std::uint32_t);
}

Words pack_fields(std::span<const Field> fields, Model model, int vectors) {
  const std::size_t per = words_per_field(model, vectors);
  Words words(fields.size() * per);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    std::vector<double> values = values_of(fields[i], model);
    if (vectors == VECTORS_HALF) {
      values.resize(2 * per);
      for (std::size_t k = 0; k < per; ++k) words[i * per + k] = halves(values[2 * k], values[2 * k + 1]);
    } else {
      for (std::size_t k = 0; k < values.size(); ++k) {
        words[place(i, k, fields.size(), model, vectors)] = word(values[k]);
      }
    }
  }
  return words;
}

std::vector<Field> unpack_fields(std::span<const std::uint32_t> words, std::size_t count, Model model, int vectors) {
  const std::size_t per = words_per_field(model, vectors);
  std::vector<Field> fields(count);
  const auto value = [&](std::size_t i, std::size_t k) -> double {
    if (vectors == VECTORS_HALF) return glm::unpackHalf2x16(words[i * per + k / 2])[static_cast<int>(k % 2)];
    return std::bit_cast<float>(words[place(i, k, count, model, vectors)]);
  };
  for (std::size_t i = 0; i < count; ++i) {
    fields[i].phi = {value(i, 0), value(i, 1), value(i, 2)};
    if (model == Model::sp3) fields[i].phi2 = {value(i, 3), value(i, 4), value(i, 5)};
  }
  return fields;
}

}  // namespace quadgraph::layouts
