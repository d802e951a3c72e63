#include "engine/file/body_names.h"

#include <algorithm>

#include "engine/base/json_text.h"
#include "engine/file/section_table.h"

namespace quadgraph {

bool is_body_name(std::string_view name) {
  if (name.empty() || name.size() > most_name_bytes) return false;
  return std::ranges::none_of(name, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 32 || byte == 127 || c == '=' || c == '/' || c == '~';
  });
}

std::vector<std::string> body_names(const std::string& metadata, const std::string& file) {
  const auto json = parse_json(metadata);
  if (!json.contains("bodies")) return {};
  const auto& bodies = json["bodies"];
  if (!bodies.is_array() || bodies.empty() || bodies.size() > most_bodies) {
    fail_format(file, "metadata", "'bodies' must list 1 to " + std::to_string(most_bodies) + " bodies");
  }
  std::vector<std::string> names;
  for (const auto& body : bodies) {
    const bool named = body.is_object() && body.contains("name") && body["name"].is_string();
    const std::string name = named ? body["name"].get<std::string>() : std::string();
    const std::string where = "'bodies', row " + std::to_string(names.size()) + ": ";
    if (!is_body_name(name)) {
      fail_format(file, "metadata",
                  where + "a 'name' of 1 to " + std::to_string(most_name_bytes) +
                      " bytes is wanted, without control characters, '=', '/' and '~'");
    }
    if (std::ranges::find(names, name) != names.end()) fail_format(file, "metadata", where + "the name occurs twice");
    names.push_back(name);
  }
  return names;
}

std::vector<std::uint32_t> body_hosts(const std::string& metadata, const std::vector<std::string>& names,
                                      const std::string& file) {
  std::vector<std::uint32_t> hosts;
  if (names.empty()) return hosts;
  const auto json = parse_json(metadata);
  for (const auto& body : json["bodies"]) {
    const auto number = static_cast<std::uint32_t>(hosts.size());
    hosts.push_back(number);
    if (!body.contains("within")) continue;
    const auto& within = body["within"];
    const auto found = within.is_string() ? std::ranges::find(names, within.get<std::string>()) : names.end();
    if (found == names.end() || *found == names[number]) {
      fail_format(file, "metadata",
                  "'bodies', row " + std::to_string(number) + ": 'within' must be the name of another body");
    }
    hosts[number] = static_cast<std::uint32_t>(found - names.begin());
  }
  const std::vector<std::uint32_t> outermost = outermost_bodies(hosts);
  for (std::size_t body = 0; body < hosts.size(); ++body) {
    if (hosts[outermost[body]] == outermost[body]) continue;
    fail_format(file, "metadata", "'bodies', row " + std::to_string(body) + ": 'within' leads in a circle");
  }
  return hosts;
}

std::vector<std::uint32_t> outermost_bodies(const std::vector<std::uint32_t>& hosts) {
  std::vector<std::uint32_t> outermost = hosts;
  for (std::uint32_t& body : outermost) {
    for (std::size_t steps = 0; steps < hosts.size() && hosts[body] != body; ++steps) body = hosts[body];
  }
  return outermost;
}

}  // namespace quadgraph
