// How an engine leans the faces by which light enters, where a normal map says so.
#include "engine/render/engine_implementation.h"
#include "engine/render/light/leaning.h"

namespace quadgraph {

void Engine::Implementation::lean_facets() {
  if (!facets_stale) return;
  const std::optional<NormalMap>& map = facets_said ? facets_said : maps.own_normals();
  std::vector<std::vector<glm::vec2>> leaning(simulation->level_count());
  if (map && map->strength > 0) leaning = leaning_faces(graph, *map, maps.is_own(*map));
  for (std::uint32_t level = 0; level < leaning.size(); ++level) simulation->set_leaning(level, leaning[level]);
  facets_stale = false;
}

void Engine::Implementation::lean_nothing() {
  if (facets_stale) return;
  for (std::uint32_t level = 0; level < simulation->level_count(); ++level) simulation->set_leaning(level, {});
  facets_stale = true;
}

}  // namespace quadgraph
