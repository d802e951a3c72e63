// How volumes are carried from body to body: what is said of it, harmonic values, and how much lengths are stretched.
#include "engine/scene/material_map.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "engine/scene/harmonic.h"
#include "engine/scene/scene.h"
#include "engine/scene/stretch.h"

using namespace quadgraph;

TEST_CASE("what is said of a map reads back as the same, and what is usual is not said") {
  for (const char* text :
       {"box", "shell", "volume", "box,scale=2", "shell,scale=0.5,repeat=clamp,depth=3", "volume,from=a b.qgraph"}) {
    CAPTURE(text);
    CHECK(to_string(parse_map(text)) == text);
    const std::string material = std::string("../wax.NPZ,map=") + text;
    CHECK(to_string(volume_name(material).value()) == material);
    CHECK(with_map("../wax.NPZ,map=box,scale=7", text) == material);
  }
  CHECK(to_string(parse_map("shell,scale=1,repeat=mirror")) == "shell");
}

TEST_CASE("a volume is known by the end of its name, whatever else is in it") {
  CHECK(volume_name("a,b.npz").value().file == "a,b.npz");
  CHECK(volume_name("a.npz,b.npz").value().file == "a.npz,b.npz");
  CHECK(volume_name("a.npz,map=box.npz,map=shell").value().file == "a.npz,map=box.npz");
  CHECK_FALSE(volume_name("marble,sigma_a=1"));
  CHECK_THROWS_WITH_AS(volume_name("a.npz,scale=2"), doctest::Contains("allowed is map=box"), InputError);
}

TEST_CASE("a scene says a map as a text or as an object, and writes what it reads") {
  const Json object{{"body", "a.qgraph"},
                    {"material", {{"volume", "w.npz"}, {"map", "shell"}, {"scale", 2}, {"from", "b.qgraph"}}}};
  const Scene scene = scene_from(JsonField(object, ""));
  CHECK(scene.material == "w.npz,map=shell,scale=2,from=b.qgraph");
  CHECK(scene_from(JsonField(to_json(scene), "")) == scene);
  const Json wrong{{"body", "a.qgraph"}, {"material", {{"volume", "w.npz"}, {"map", "box"}, {"depth", 2}}}};
  CHECK_THROWS_WITH_AS(scene_from(JsonField(wrong, "")), doctest::Contains("/material: map: depth: found with box"),
                       InputError);
}

TEST_CASE("values between given ones on a line fall evenly, by weights as resistances") {
  const WeightedGraph graph{.begin = {0, 1, 3, 5, 6}, .to = {1, 0, 2, 1, 3, 2}, .weight = {1, 1, 0.5, 0.5, 1, 1}};
  std::vector<double> values = {0, 7, -3, 4};
  make_harmonic(graph, {1, 0, 0, 1}, values, 1e-14);
  CHECK(values[1] == doctest::Approx(1));
  CHECK(values[2] == doctest::Approx(3));
}

TEST_CASE("singular values are those of the stretch that a turned matrix has") {
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, 2, -1))));
  const glm::dmat3 other(glm::rotate(glm::dmat4(1), -1.9, glm::normalize(glm::dvec3(0, 1, 3))));
  for (const glm::dvec3& factors :
       {glm::dvec3(3, 2, 0.5), glm::dvec3(2, 2, 2), glm::dvec3(5, 1, 1), glm::dvec3(2, 1, 0)}) {
    glm::dmat3 stretched(0);
    for (int k = 0; k < 3; ++k) stretched[k][k] = factors[k];
    const std::array<double, 3> found = singular_values(turn * stretched * other);
    for (int k = 0; k < 3; ++k) {
      CHECK(found[static_cast<std::size_t>(k)] == doctest::Approx(factors[k]).epsilon(1e-6).scale(1));
    }
  }
}

TEST_CASE("stretch is what a length becomes, by weight") {
  StretchCount count(2);
  glm::dmat3 back(0);
  back[0][0] = 0.5;
  back[1][1] = 0.25;
  count.add(back, 9);
  back[1][1] = 0.01;
  count.add(back, 1);
  const Stretch found = count.percentiles();
  CHECK(found.low == doctest::Approx(2));
  CHECK(found.median == doctest::Approx(2));
  CHECK(found.high == doctest::Approx(4));
}
