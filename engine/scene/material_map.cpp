#include "engine/scene/material_map.h"

#include <algorithm>
#include <cctype>

#include "engine/base/text.h"

namespace quadgraph {
namespace {

constexpr std::string_view suffix = ".npz";
constexpr std::array<std::string_view, 4> map_members = {"scale", "repeat", "depth", "from"};

std::string lower(std::string_view text) {
  std::string made(text);
  std::transform(made.begin(), made.end(), made.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return made;
}

float number_in(std::string_view text, const std::string& name, const Range& range) {
  const auto value = static_cast<float>(parse_number(text, "map: " + name));
  if (range.contains(value)) return value;
  throw InputError("map: " + name + ": found " + number_text(value) + ", allowed is " + range.text());
}

void refuse_of(MapKind kind, std::string_view member, std::string_view goes_with) {
  throw InputError("map: " + std::string(member) + ": found with " + std::string(name_of(kind)) + ", allowed with " +
                   std::string(goes_with) + "; leave it out");
}

void put_member(MaterialMap& map, std::string_view name, std::string_view value) {
  if (name == "scale") {
    if (map.kind == MapKind::volume) refuse_of(map.kind, name, "box and shell");
    map.scale = number_in(value, "scale", map_scale_range);
  } else if (name == "repeat") {
    if (map.kind == MapKind::volume) refuse_of(map.kind, name, "box and shell");
    map.repeat = from_name<MapRepeat>(value);
  } else if (name == "depth") {
    if (map.kind != MapKind::shell) refuse_of(map.kind, name, "shell");
    map.depth = number_in(value, "depth", map_depth_range);
  } else if (name == "from") {
    map.from = value;
    if (lower(map.from.extension().string()) != ".qgraph") {
      throw InputError("map: from: found '" + std::string(value) +
                       "', allowed is a baked .qgraph, the body that the volume was found in; bake it first");
    }
  } else {
    throw InputError("map: '" + std::string(name) + "'" + meant(name, map_members) +
                     ": allowed behind box, shell or volume are scale=NUMBER, repeat=mirror or clamp, depth=MM and "
                     "from=BODY.qgraph");
  }
}

}  // namespace

MaterialMap parse_map(std::string_view text) {
  const std::vector<std::string_view> parts = split(text, ',');
  MaterialMap map{.kind = from_name<MapKind>(parts.front())};
  std::vector<std::string_view> seen;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = std::min(parts[i].find('='), parts[i].size());
    const std::string_view name = parts[i].substr(0, equals);
    if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
      throw InputError("map: " + std::string(name) + ": found twice, allowed is once");
    }
    seen.push_back(name);
    put_member(map, name, parts[i].substr(std::min(equals + 1, parts[i].size())));
  }
  return map;
}

std::string to_string(const MaterialMap& map) {
  const MaterialMap usual;
  std::string text(name_of(map.kind));
  if (map.scale != usual.scale) text += ",scale=" + number_text(map.scale);
  if (map.repeat != usual.repeat) text += ",repeat=" + std::string(name_of(map.repeat));
  if (map.depth) text += ",depth=" + number_text(*map.depth);
  if (!map.from.empty()) text += ",from=" + map.from.string();
  return text;
}

std::optional<VolumeName> volume_name(std::string_view text) {
  const std::string material = without_coat(text);
  const std::string small = lower(material);
  const std::size_t with_map = small.rfind(std::string(suffix) + ",map=");
  if (with_map != std::string::npos) {
    const std::size_t end = with_map + suffix.size();
    return VolumeName{material.substr(0, end), parse_map(material.substr(end + 5)), stated_coat(text)};
  }
  if (small.ends_with(suffix)) return VolumeName{material, {}, stated_coat(text)};
  const std::size_t other = small.rfind(std::string(suffix) + ",");
  if (other == std::string::npos) return std::nullopt;
  throw InputError(
      "material: found '" + material.substr(other + suffix.size() + 1) +
      "' behind the name of a volume, allowed is map=box, map=shell or map=volume, and what goes with it, and coat=");
}

std::string to_string(const VolumeName& name) {
  return with_coat(name.file.string() + (name.map ? ",map=" + to_string(*name.map) : ""), name.coat);
}

std::string with_map(std::string_view material, std::string_view map) {
  std::optional<VolumeName> name = volume_name(material);
  if (!name) {
    throw InputError("map: found with the material '" + std::string(material) +
                     "', allowed with a volume, the name of a file .npz; leave the map out");
  }
  name->map = parse_map(map);
  return to_string(*name);
}

}  // namespace quadgraph
