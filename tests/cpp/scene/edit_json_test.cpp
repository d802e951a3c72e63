// Layers of edits in scene files.
#include "engine/scene/edit_json.h"

#include <doctest/doctest.h>

#include "engine/base/error.h"

using namespace quadgraph;

namespace {

const std::string edit = R"({"operation": "multiply", "sigma_a": 2})";

std::vector<EditLayer> read(const std::string& edits) {
  const Json json = Json::parse("[" + edits + "]");
  return layers_from(JsonField(json, "/edits"));
}

void check_refused_layers(const std::string& edits, const std::string& where) {
  std::string said = "nothing was refused";
  try {
    read(edits);
  } catch (const InputError& error) {
    said = error.what();
  }
  INFO("said: " << said);
  CHECK(said.starts_with(where));
}

}  // namespace

TEST_CASE("edits without a layer are one, and that alone is written as edits") {
  const std::vector<EditLayer> plain = read(edit + "," + edit);
  REQUIRE(plain.size() == 1);
  CHECK(plain[0] == EditLayer{.name = "Layer 1", .edits = {plain[0].edits[0], plain[0].edits[0]}});
  CHECK(layers_json(plain) == Json::parse("[" + edit + "," + edit + "]"));
  CHECK(read("").empty());
  CHECK(layers_json({}) == Json::array());
  const std::vector<EditLayer> empty{{.name = layer_name(1)}};
  const Json empty_json = layers_json(empty);
  CHECK(layers_from(JsonField(empty_json, "/edits")) == empty);
  const EditLayer named{.name = "Layer 2", .edits = plain[0].edits};
  const EditLayer hidden{.name = "Layer 1", .visible = false, .edits = plain[0].edits};
  const EditLayer weak{.name = "Layer 1", .opacity = 0.5f, .edits = plain[0].edits};
  for (const EditLayer& other : {named, hidden, weak}) CHECK(layers_json({other})[0].contains("edits"));
}

TEST_CASE("edits between layers are layers with names by their place") {
  const std::vector<EditLayer> mixed = read(edit + R"(,{"name": "Veins", "visible": false, "edits": []},)" + edit);
  REQUIRE(mixed.size() == 3);
  CHECK(mixed[0].name == "Layer 1");
  CHECK(!mixed[1].visible);
  CHECK(mixed[2].name == "Layer 3");
  const Json json = layers_json(mixed);
  CHECK(json[1] == Json::parse(R"({"name": "Veins", "visible": false, "opacity": 1.0, "edits": []})"));
  CHECK(layers_from(JsonField(json, "/edits")) == mixed);
}

TEST_CASE("bad layers and mirror images: the path into the file, what was found, what is allowed") {
  check_refused_layers("3", "/edits/0: found 3");
  check_refused_layers(R"({"name": 3, "edits": []})", "/edits/0/name: found 3, allowed is a text");
  check_refused_layers(R"({"edits": []})", "/edits/0/name: found nothing");
  check_refused_layers(R"({"name": "a"})", "/edits/0/edits: found nothing");
  check_refused_layers(R"({"name": "", "edits": []})", "/edits/0: name: found 0 bytes, allowed are 1 to 64");
  check_refused_layers(R"({"name": "a", "opacity": 1.5, "edits": []})", "/edits/0/opacity: found 1.5");
  check_refused_layers(R"({"name": "a", "visible": 1, "edits": []})", "/edits/0/visible: found 1");
  check_refused_layers(R"({"name": "a", "edits": [], "mode": "add"})", "/edits/0/mode: found \"add\"");
  check_refused_layers(R"({"name": "a", "edits": [{"name": "b", "edits": []}]})", "/edits/0/edits/0/name: found");
  check_refused_layers(R"({"name": "a", "edits": [{"operation": "add"}]})", "/edits/0/edits/0: sigma_s_prime");
  const std::string stroke = R"({"operation": "add", "sigma_a": 1, "stroke": [[0, 0, 0]], "radius": 1, "mirrored": )";
  check_refused_layers(stroke + "3}", "/edits/0/mirrored: found 3, allowed is an object");
  check_refused_layers(stroke + R"({"axis": "x"}})", "/edits/0/mirrored/axis: found \"x\"");
  check_refused_layers(stroke + "{}}", "/edits/0: mirrored: stroke: found 0");
}

TEST_CASE("more layers than a scene may have are refused before they are read") {
  std::string many = R"({"name": "a", "edits": []})";
  for (std::size_t i = 1; i < most_layers; ++i) many += R"(,{"name": "a", "edits": []})";
  CHECK(read(many).size() == most_layers);
  check_refused_layers(many + "," + edit, "/edits/256: found");
  check_refused_layers(many + R"(,{"name": 3})", "/edits/256: found");
}
