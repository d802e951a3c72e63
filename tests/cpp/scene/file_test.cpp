// Scene files: what they say, what changes from frame to frame, and what is wrong with them.
#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <tuple>

#include "engine/base/error.h"
#include "engine/render/light/default_lights.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/stage.h"
#include "tests/cpp/fixtures/test_data.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

const std::filesystem::path cube = test_data("tiny.qgraph");

// A folder of the test's own.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("quadgraph-scene-" + std::to_string(getpid()));

  Folder() { std::filesystem::create_directories(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }

  SceneFile scene(const std::string& text) const {
    std::ofstream(path / "scene.json") << text;
    return SceneFile::load(path / "scene.json");
  }
};

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

void check_refused(const std::string& text, const std::string& where) {
  const Folder folder;
  const std::string said = refusal([&] { folder.scene(text); });
  INFO("said: " << said);
  CHECK(said.find("scene.json: " + where) != std::string::npos);
}

// A Radiance picture of one texel in `folder`.
std::string one_texel(const Folder& folder) {
  const std::filesystem::path path = folder.path / "texel.hdr";
  std::ofstream(path, std::ios::binary) << "#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x81";
  return path.string();
}

std::vector<EditLayer> layers() {
  std::vector<Edit> edits = {{.operation = Edit::Operation::multiply,
                              .sigma_a = glm::vec3(2, 1, 0.1f),
                              .stroke = {{0, 0, 0}, {1, 0.3f, 0}},
                              .radius = 0.7f,
                              .depth_from = 0.1f,
                              .depth_to = 0.9f,
                              .softness = 0.25f},
                             {.operation = Edit::Operation::set, .sigma_s_prime = glm::vec3(3)}};
  edits[0].mirrored = EditMirror{.stroke = {{3, 0, 0}, {2, 0.3f, 0}}};
  Edit stamp{.sigma_a = glm::vec3(2), .placement = Placement{.centre = {1, 1, 2}, .size = {1, 1, 0.5f}}};
  stamp.mirrored = EditMirror{.placement = stamp.placement};
  return {{.name = "Spots & \xc3\xa4", .opacity = 0.25f, .edits = edits},
          {.name = "Layer 1", .visible = false, .edits = {stamp}},
          {.name = "none yet"}};
}

Scene with_everything(const Folder& folder) {
  Scene scene;
  scene.body = cube;
  scene.material = "skin1,eta=1.4";
  scene.layers = layers();
  scene.lights = {parse_light("directional:0,0.6,-0.8:1/2/3"),
                  parse_light("point:1,2,3:0.1"),
                  parse_light("ambient:0.5"),
                  parse_light("spot:1,2,3:0,0.6,-0.8:20,0.5:4"),
                  parse_light("rectangle:1,2,3:4,0,0:0,5,1:6/7/8"),
                  parse_light("projector:1,2,3:0,0.6,-0.8:20,1,1,0:" + one_texel(folder) + ":4"),
                  parse_light("environment:" + one_texel(folder) + ":30,z:2")};
  Deformer twist{.degrees = 30}, bend{.kind = DeformerKind::bend}, scaled{.kind = DeformerKind::transform};
  bend.towards = {0, 0.5, 1};
  bend.range_in_mm = true;
  bend.begin = 0.2;
  bend.end = 1.8;
  bend.centre = glm::dvec3(1, 1, 1);
  bend.degrees = 20;
  scaled.scale = {1, 2, 1.1};
  scaled.translate = {0, 3, 0};
  Deformer taper{.kind = DeformerKind::taper, .axis = {1, 0, 0}, .factor = 0.7};
  Deformer lattice{.kind = DeformerKind::lattice, .basis = LatticeBasis::linear};
  lattice.displacements.assign(8, {0, 0, 0.1});
  lattice.box = RestBox{glm::dvec3(-1), glm::dvec3(3)};
  Deformer cage{.kind = DeformerKind::cage};
  cage.cage = {{-4, -4, -4}, {12, -4, -4}, {-4, 12, -4}, {-4, -4, 12}};
  cage.moved = cage.cage;
  cage.moved[3].z = 13;
  cage.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  scene.deformation = {twist, bend, taper, lattice, cage, scaled};
  scene.view = {.azimuth = 33.3f,
                .elevation = -5,
                .distance = 12.5f,
                .up = UpAxis::z,
                .vertical_fov = 40,
                .target = {1, -2, 0.5f},
                .aperture = 2.5f,
                .focus = 9.25f};
  scene.solve = {.method = Method::quadgraph_fv, .solver = SolverKind::dpcg, .tolerance = 0.002, .cycles = 3};
  scene.render = {.width = 64,
                  .height = 48,
                  .samples = 36,
                  .roughness = 0.2f,
                  .radiance = Radiance::lambertian,
                  .show = parse_show("tets:y,-3,1"),
                  .ground = true};
  scene.tone = {.exposure_stops = 1.5f, .background_top = {1, 0.5f, 0}, .background_bottom = glm::vec3(0.1f)};
  scene.tone.curve = ToneCurve::agx;
  scene.tone.white_balance = 4100;
  return scene;
}

}  // namespace

TEST_CASE("a scene reads back as the same, from another folder too") {
  const Folder folder;
  const Scene scene = with_everything(folder);
  std::filesystem::create_directories(folder.path / "deep");
  SceneFile(scene).save(folder.path / "deep" / "a.json");
  const Scene read = SceneFile::load(folder.path / "deep" / "a.json").at(0);
  CHECK(read == scene);
  std::filesystem::copy(cube, folder.path / "cube.qgraph");
  folder
      .scene(R"({"body": "cube.qgraph", "lights": [{"type": "projector", "position": [0, 0, 9], "direction": [0, 0, -1],
                 "angle": 20, "file": "cube.qgraph", "power": 1}]})")
      .save(folder.path / "deep" / "b.json");
  const Scene moved = SceneFile::load(folder.path / "deep" / "b.json").at(0);
  CHECK(std::filesystem::equivalent(moved.body, folder.path / "cube.qgraph"));
  CHECK(std::filesystem::equivalent(moved.lights[0].file, folder.path / "cube.qgraph"));
}

TEST_CASE("what a file does not say is the default, and its lights belong to the first view") {
  const Folder folder;
  const SceneFile file = folder.scene(
      R"({"body": "a.qgraph", "camera": {"azimuth": 20}, "tracks": [{"path": "/camera/azimuth", "keys": [[0, 20], [9, 65]]}]})");
  Scene expected;
  expected.body = folder.path / "a.qgraph";
  expected.view.azimuth = 20;
  expected.lights = {studio_of(expected.view)};
  expected.render.ground = true;
  expected.view.framing = Framing::turned;  // the camera goes around
  CHECK(file.at(0) == expected);
  expected.view.azimuth = 65;
  CHECK(file.at(9) == expected);
  CHECK(file.frames() == 10);
  const Scene dark = folder.scene(R"({"body": "a.qgraph", "lights": []})").at(0);
  CHECK(dark.lights.empty());
  CHECK(!dark.render.ground);
  CHECK(!folder.scene(R"({"body": "a.qgraph", "picture": {"ground": false}})").at(0).render.ground);
  CHECK(folder.scene(R"({"body": "a.qgraph"})").at(0).view.framing == Framing::automatic);
}

TEST_CASE("tracks move numbers and triples, step through all else, and stay beyond their ends") {
  const Folder folder;
  const SceneFile file = folder.scene(R"({
    "body": "a.qgraph", "frames": 30, "frames_per_second": 25, "material": {"name": "marble", "sigma_a": 0.1},
    "lights": [{"type": "point", "position": [0, 0, 9], "power": 1}],
    "tracks": [
      {"path": "/lights/0/position", "keys": [[10, [0, 0, 9]], [20, [8, 4, 9]]]},
      {"path": "/material/sigma_a", "keys": [[0, 0.1], [10, 0.3]], "between": "smooth"},
      {"path": "/camera/fov", "keys": [[0, 20], [10, 40]]},
      {"path": "/solver/model", "keys": [[0, "sp3"], [5, "diffusion"]], "between": "step"}]})");
  CHECK(file.frames() == 30);
  CHECK(file.frames_per_second() == 25);
  CHECK(file.at(0).lights[0].position == glm::vec3(0, 0, 9));
  CHECK(file.at(15).lights[0].position == glm::vec3(4, 2, 9));
  CHECK(file.at(29).lights[0].position == glm::vec3(8, 4, 9));
  CHECK(file.at(5).material == "marble,sigma_a=0.2");
  const double t = 0.25 * 0.25 * (3 - 2 * 0.25);
  CHECK(std::stod(file.at(2.5).material.substr(15)) == doctest::Approx(0.1 + 0.2 * t));
  CHECK(file.at(2.5).view.vertical_fov == 25);
  CHECK(file.at(4.9).solve.model == Model::sp3);
  CHECK(file.at(5).solve.model == Model::diffusion);
}

TEST_CASE("a value is set where it belongs, or nothing is") {
  const Folder folder;
  SceneFile file = folder.scene(R"({"body": "a.qgraph", "lights": [{"type": "ambient", "irradiance": 1}]})");
  file.set("/camera/fov", "40");
  file.set("/material", "jade");
  file.set("/lights/0/irradiance", "[1, 2, 3]");
  CHECK(file.at(0).view.vertical_fov == 40);
  CHECK(file.at(0).material == "jade");
  CHECK(file.at(0).lights[0].power == glm::vec3(1, 2, 3));
  const Scene before = file.at(0);
  for (const auto& [pointer, value, said] :
       {std::tuple{"/lights/1/irradiance", "1", "allowed is the path of a value"},
        std::tuple{"camera/fov", "1", "allowed is the path of a value"}, std::tuple{"", "1", "the path of a value"},
        std::tuple{"/camera/fov", "400", "/camera: view, field of view"},
        std::tuple{"/camera/zoom", "4", "/camera/zoom: found 4, allowed is nothing of this name"}}) {
    CAPTURE(pointer);
    const std::string found = refusal([&, p = pointer, v = value] { file.set(p, v); });
    CAPTURE(found);
    CHECK(found.find(said) != std::string::npos);
    CHECK(file.at(0) == before);
  }
}

TEST_CASE("a track that changes what is set is left out, and others go on") {
  const Folder folder;
  SceneFile file = folder.scene(R"({"body": "a.qgraph", "lights": [{"type": "ambient", "irradiance": 1}], "tracks": [
      {"path": "/camera/fov", "keys": [[0, 20], [9, 60]]}, {"path": "/camera/azimuth", "keys": [[0, 0], [9, 90]]},
      {"path": "/camera/fov", "keys": [[0, 10], [9, 90]]},
      {"path": "/lights/0/irradiance", "keys": [[0, [1, 2, 3]], [9, [3, 2, 1]]]}]})");
  file.set("/camera/fov", "40");
  for (const double frame : {0.0, 9.0}) {
    CHECK(file.at(frame).view.vertical_fov == 40);
    CHECK(file.at(frame).view.azimuth == doctest::Approx(10 * frame));
  }
  const Scene before = file.at(9);
  CHECK(refusal([&] { file.set("/lights/0/irradiance/1", "5"); }).find("at /tracks/1") != std::string::npos);
  CHECK(file.at(9) == before);
}

TEST_CASE("the frames of a file go on over another scene, which says all that they do not change") {
  const Folder folder;
  const SceneFile file = folder.scene(R"({
    "body": "a.qgraph", "frames": 5, "frames_per_second": 12, "material": {"name": "marble", "sigma_a": 0.1},
    "camera": {"azimuth": 0}, "lights": [{"type": "ambient", "irradiance": 1}],
    "tracks": [{"path": "/material/sigma_a", "keys": [[0, 0.1], [4, 0.3]]},
               {"path": "/camera/azimuth", "keys": [[0, 0], [4, 80]]}]})");
  Scene other = file.at(0);
  other.view.azimuth = 250;
  other.lights[0].power = glm::vec3(7);
  other.render.width = 64;
  const SceneFile both = file.with(other);
  CHECK(both.frames() == 5);
  CHECK(both.frames_per_second() == 12);
  both.save(folder.path / "both.json");
  const SceneFile read = SceneFile::load(folder.path / "both.json");
  CHECK(read.at(2).material == "marble,sigma_a=0.2");
  CHECK(read.at(2).view.azimuth == 40);
  CHECK(read.at(2).lights[0].power == glm::vec3(7));
  CHECK(read.at(2).render.width == 64);
  CHECK(std::filesystem::weakly_canonical(read.at(0).body) == std::filesystem::weakly_canonical(file.at(0).body));
  other.material = "jade";
  CHECK(refusal([&] { file.with(other); }).find("/material") != std::string::npos);
}

TEST_CASE("bad scenes: the path into the file, what was found, what is allowed") {
  check_refused("{\"body\":\n \"a\",\n ]", "no JSON at line 3, column 2");
  check_refused("[]", "/: found [], allowed is an object of");
  check_refused("{}", "/body: found nothing, a value is required");
  check_refused(R"({"body": 3})", "/body: found 3, allowed is a text");
  check_refused(R"({"quadgraph_scene": 2, "body": "a"})", "/quadgraph_scene: found 2, allowed is a whole number");
  check_refused(R"({"body": "a", "ligths": []})", "/ligths: found [], allowed is nothing of this name; allowed are");
  check_refused(R"({"body": "a", "material": "stone"})", "/material: material 'stone': allowed are apple");
  check_refused(R"({"body": "a", "material": {"name": "skin1", "eta": 9}})", "/material: material field 'eta'");
  check_refused(R"({"body": "a", "material": {"name": "skin1", "eta": [true]}})", "/material/eta/0: found true");
  check_refused(R"({"body": "a", "lights": [{"type": "laser"}]})", "/lights/0/type: found \"laser\", allowed is");
  check_refused(R"({"body": "a", "lights": [{"type": "ambient", "irradiance": -1}]})", "/lights/0: light 'ambient:-1'");
  check_refused(R"({"body": "a", "lights": [{"type": "directional", "direction": [0, 0, 0], "irradiance": 1}]})",
                "/lights/0/direction: found [0,0,0], allowed is a direction");
  check_refused(R"({"body": "a", "camera": {"elevation": 91}})", "/camera: view, elevation: found 91");
  check_refused(R"({"body": "a", "camera": {"up": "x"}})", "/camera/up: up 'x': allowed are y, z");
  check_refused(R"({"body": "a", "solver": {"method": "fen"}})",
                "/solver/method: method 'fen' (did you mean 'fem'?): allowed are");
  check_refused(R"({"body": "a", "solver": {"tolerance": 2}})", "/solver: tolerance");
  check_refused(R"({"body": "a", "solver": {"bounces": 1.5}})",
                "/solver/bounces: found 1.5, allowed is a whole number");
  check_refused(R"({"body": "a", "picture": {"width": 0}})",
                "/picture/width: found 0, allowed is a whole number from 1");
  check_refused(R"({"body": "a", "picture": {"background": [2, 0, 0]}})", "/picture/background: background");
  check_refused(R"({"body": "a", "edits": [{"operation": "add"}]})", "/edits/0: sigma_s_prime, sigma_a: found neither");
  check_refused(R"({"body": "a", "edits": [{"operation": "dye", "sigma_a": 1}]})", "/edits/0/operation: found \"dye\"");
  const auto deformer = [](const std::string& text) { return R"({"body": "a", "deformation": [{)" + text + "}]}"; };
  check_refused(deformer(R"("type": "squash")"), "/deformation/0/type: ");
  check_refused(deformer(R"("type": "twist")"), "/deformation/0/degrees: found nothing");
  check_refused(deformer(R"("type": "twist", "degrees": 9, "factor": 2)"), "/deformation/0/factor: found 2");
  check_refused(deformer(R"("type": "twist", "degrees": 9, "range": [1, 0])"), "/deformation/0: ");
  check_refused(deformer(R"("type": "stretch", "factor": 0)"), "/deformation/0: ");
  check_refused(deformer(R"("type": "stretch", "factor": 2, "range": [0, 1], "range_mm": [0, 1])"),
                "/deformation/0/range_mm: found");
  check_refused(deformer(R"("type": "lattice", "size": [2, 2, 40], "displacements": [])"),
                "/deformation/0/size/2: found 40");
  check_refused(R"({"body": "a", "frames": 0})", "/frames: found 0");
  const auto track = [](const std::string& text) { return R"({"body": "a", "tracks": [{)" + text + "}]}"; };
  check_refused(track(R"("path": "/camera/fov", "keys": [[0, 1], [0, 2]])"), "/tracks/0/keys/1/0: found 0");
  check_refused(track(R"("path": "/camera/fov", "keys": [[0, 20], [1, [2]]])"), "/tracks/0/keys/1/1: found [2]");
  check_refused(track(R"("path": "/camera/fov", "keys": [])"), "/tracks/0/keys: found []");
  check_refused(track(R"("path": "/lights/0/power", "keys": [[0, 1]])"), "/lights");
  check_refused(track(R"("path": "/camera/fov", "keys": [[0, 20], [5, 200]])"), "/camera: view, field of view");
  const std::string said = refusal([] { SceneFile::load("/nowhere/scene.json"); });
  CHECK(said == "/nowhere/scene.json: cannot be read (No such file or directory)");
}

TEST_CASE("a stage that went through other scenes shows the same as a fresh one") {
  const Folder folder;
  Scene scene = with_everything(folder);
  scene.solve = {};
  Scene other = scene;
  other.material = "ketchup";
  other.layers.clear();
  other.deformation.pop_back();
  other.lights.pop_back();
  Stage travelled(test_device()), fresh(test_device());
  for (const Scene& shown : {scene, other, scene}) {
    travelled.show(shown);
    travelled.solve();
  }
  fresh.show(scene);
  fresh.solve();
  const auto a = travelled.engine().surface_field().exitance, b = fresh.engine().surface_field().exitance;
  CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end()));
  CHECK(travelled.render().scattered == fresh.render().scattered);
  travelled.show(other);
  travelled.solve();
  CHECK(travelled.engine().surface_field().exitance != b);
  for (Stage* stage : {&travelled, &fresh}) {
    for (const auto& message : stage->engine().device().validation_messages()) FAIL_CHECK(message);
  }
}
