#include "engine/render/inside/show.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace quadgraph {
namespace {

[[noreturn]] void refuse(std::string_view text) {
  throw InputError("show '" + std::string(text) + "': allowed are " + show_forms);
}

std::uint32_t parse_level(std::string_view text, std::string_view whole) {
  const double level = parse_number(text, "show '" + std::string(whole) + "', level");
  if (level < 0 || level > 99 || level != std::floor(level)) refuse(whole);
  return static_cast<std::uint32_t>(level);
}

void parse_plane(std::string_view rest, std::string_view whole, Show& show) {
  const auto parts = split(rest, ',');
  const std::size_t axis = std::string_view("xyz").find(parts[0]);
  if (parts[0].size() != 1 || axis == std::string_view::npos || parts.size() > (has_level(show.quantity) ? 3u : 2u)) {
    refuse(whole);
  }
  show.axis = static_cast<int>(axis);
  if (parts.size() > 1) show.offset = static_cast<float>(parse_number(parts[1], "show, place of the plane"));
  if (parts.size() > 2) show.level = parse_level(parts[2], whole);
}

}  // namespace

const char* const show_forms =
    "picture, q, exitance, error, difference[:METHOD], levels[:N], phi[:AXIS[,MM]], tets[:AXIS[,MM[,N]]], "
    "links[:AXIS[,MM[,N]]], sigma_s_prime_deviation[:AXIS[,MM]], sigma_a_deviation[:AXIS[,MM]], "
    "sigma_s_prime_resolution[:AXIS[,MM]] and sigma_a_resolution[:AXIS[,MM]]; AXIS x, y or z, MM from the object's "
    "centre, N a level, 0 the finest";

bool has_plane(Quantity quantity) {
  return quantity == Quantity::phi || quantity == Quantity::tets || quantity == Quantity::links ||
         knowledge_of(quantity).has_value();
}

std::optional<Knowledge> knowledge_of(Quantity quantity) {
  const auto found = std::find(knowledge_names.begin(), knowledge_names.end(), name_of(quantity));
  if (found == knowledge_names.end()) return std::nullopt;
  return static_cast<Knowledge>(found - knowledge_names.begin());
}

bool has_level(Quantity quantity) {
  return quantity == Quantity::levels || quantity == Quantity::tets || quantity == Quantity::links;
}

Show parse_show(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto& known = Names<Quantity>::values;
  const auto found = std::find_if(known.begin(), known.end(),
                                  [&](const Named<Quantity>& named) { return named.name == text.substr(0, colon); });
  if (found == known.end()) refuse(text);
  Show show{.quantity = found->value};
  if (colon == std::string_view::npos) return show;
  const std::string_view rest = text.substr(colon + 1);
  if (has_plane(show.quantity)) {
    parse_plane(rest, text, show);
  } else if (show.quantity == Quantity::levels) {
    show.level = parse_level(rest, text);
  } else if (show.quantity == Quantity::difference) {
    show.other = from_name<Method>(rest);
  } else {
    refuse(text);
  }
  return show;
}

std::string to_string(const Show& show) {
  std::string text(name_of(show.quantity));
  if (show.quantity == Quantity::difference) return text + ":" + std::string(name_of(show.other));
  if (has_plane(show.quantity)) text += ":" + std::string(1, "xyz"[show.axis]) + "," + number_text(show.offset);
  if (has_level(show.quantity)) text += (has_plane(show.quantity) ? "," : ":") + std::to_string(show.level);
  return text;
}

float Legend::place(double value) const {
  if (!(high > low)) return 0.5f;
  if (!logarithmic) return static_cast<float>((value - low) / (high - low));
  return static_cast<float>(std::log(std::max(value, 1e-300) / low) / std::log(high / low));
}

double Legend::value_at(double place) const {
  return logarithmic ? low * std::pow(high / low, place) : low + place * (high - low);
}

}  // namespace quadgraph
