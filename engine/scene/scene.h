// What a user shows, as a value: it can be compared, kept for undo, saved and loaded. docs/scene.md describes the file.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/deform/body_poses.h"
#include "engine/deform/cut.h"
#include "engine/deform/deformer.h"
#include "engine/optics/edit_layer.h"
#include "engine/render/display/camera.h"
#include "engine/render/engine.h"
#include "engine/render/light/lights.h"
#include "engine/render/picture/tone_map.h"
#include "engine/scene/json_field.h"

namespace quadgraph {

struct Scene {
  std::filesystem::path body;                      // .qgraph
  std::string material = "marble";                 // as parse_material reads it, or a volume's file
  std::map<std::string, std::string> materials{};  // the same of bodies by their names; others have `material`
  std::vector<EditLayer> layers{};                 // of edits of the material, one after the other
  std::vector<Light> lights{};
  BodyPoses placements{};               // of bodies by their names; others lie as in the file
  std::vector<Deformer> deformation{};  // one after the other, of all bodies where they have been put
  std::vector<BodyCut> cuts{};          // away from the body as it is shown; only with shortest-path
  View view{};
  SolveOptions solve{.correction = true};
  RenderOptions render{};
  ToneOptions tone{};

  bool operator==(const Scene&) const = default;
};

// The text of the material of a body by its name; without one, or of one that has none of its own, that of all.
const std::string& said_material(const Scene& scene, const std::string& body);

// Reads the members of a scene file that say what is shown, and leaves others alone. Throws InputError with the path of
// what is wrong.
Scene scene_from(const JsonField& document);

// What scene_from reads back as the same scene.
Json to_json(const Scene& scene);

}  // namespace quadgraph
