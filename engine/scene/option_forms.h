// Options of a scene that are one text on a command line and several members of the scene, or members of another form.
#pragma once

#include "engine/scene/options.h"

namespace quadgraph {

const std::string& text_in(const OptionValue& value);

// What --material takes, with all names.
std::string material_help();

// What --material-of takes.
std::string body_help();

// "BODY=M" for each body that has a material of its own; to set them leaves those of other bodies as they are.
OptionValue materials_of(const Scene& scene);
void set_materials_of(Scene& scene, const OptionValue& value);

// How the volume that is the material is carried into the body.
std::string map_help();

// The texts that a light may have, and what there is without.
std::string light_help();
OptionValue map_of(const Scene& scene);
void set_map(Scene& scene, const OptionValue& value);

// One text per light.
OptionValue lights_of(const Scene& scene);
void set_lights(Scene& scene, const OptionValue& value);

// The camera as a text for parse_view; nothing for the default one, whose azimuth is the front of the body. Set, it
// takes the place of eye and look_at.
OptionValue view_of(const Scene& scene);
void set_view(Scene& scene, const OptionValue& value);

// Places as texts for parse_place; nothing where there are none.
OptionValue eye_of(const Scene& scene);
void set_eye(Scene& scene, const OptionValue& value);
OptionValue look_at_of(const Scene& scene);
void set_look_at(Scene& scene, const OptionValue& value);

// "1024x768".
OptionValue size_of(const Scene& scene);
void set_size(Scene& scene, const OptionValue& value);

// "auto", or stops as a number.
OptionValue stops_of(const Scene& scene);
void set_stops(Scene& scene, const OptionValue& value);

// The file of a normal map over all of the body; nothing where there is none, or it lies elsewhere.
OptionValue normal_map_of(const Scene& scene);
void set_normal_map(Scene& scene, const OptionValue& value);

// The background as a text for parse_background; nothing for a gradient other than the default one.
OptionValue background_of(const Scene& scene);
void set_background(Scene& scene, const OptionValue& value);

}  // namespace quadgraph
