// What a solve takes from the record of a bake for an error, and what is wrong with records that no bake wrote.
#include "engine/scene/measured_error.h"

#include <doctest/doctest.h>

#include <functional>
#include <tuple>

#include "engine/base/error.h"
#include "engine/scene/json_field.h"
#include "engine/solve/asked_error.h"

using namespace quadgraph;

namespace {

Json trial(const char* model, int cycles, double cost, double whole, double unlit, int sweeps = 0) {
  return {{"surface_vertices", 500},
          {"levels", 2},
          {"deep", true},
          {"model", model},
          {"cycles", cycles},
          {"sweeps", sweeps},
          {"cost", cost},
          {"errors", {{"given", {{"whole", whole}, {"unlit", unlit}}}}},
          {"share", 0.95}};
}

Json record() {
  Json other = trial("diffusion", 1, 1, 0.001, 0.001);
  other["surface_vertices"] = 900;  // on another file
  return {{"error", 0.05},
          {"material", "skin1"},
          {"lights", {{"given", {"directional:0,0,-1:1", "ambient:0.50"}}}},
          {"lights_given", true},
          {"inter_reflection", true},
          {"surface_vertices", 500},
          {"levels", {500, 90}},
          {"trials",
           {other, trial("diffusion", 2, 100, 0.03, 0.0476), trial("diffusion", 3, 150, 0.03, 0.045),
            trial("sp3", 2, 200, 0.01, 0.03), trial("sp3", 3, 300, 0.01, 0.012)}}};
}

std::string metadata(const Json& budget) {
  return Json{{"generator", "test"}, {"budget", budget}}.dump();
}

PresentScene scene() {
  return {.file = "a.qgraph",
          .material = "skin1",
          .lights = {parse_light("ambient:0.5"), parse_light("directional:0,0,-2:1")}};
}

MeasuredOptions asked(const SolveOptions& options, const PresentScene& where = scene(), const Json& what = record()) {
  return with_measured(options, metadata(what), where);
}

// Whether the options stayed as they were, for a reason with these words.
void check_left(const SolveOptions& options, const PresentScene& where, const std::string& words) {
  const MeasuredOptions found = asked(options, where);
  INFO("said: " << found.sentence);
  CHECK(found.options == options);
  CHECK(found.sentence.find("the bake measured " + words) != std::string::npos);
  CHECK(found.sentence.find("the solve's own estimate decides") != std::string::npos);
}

std::string refusal(const std::string& text) {
  try {
    with_measured({.error = 0.05}, text, scene());
  } catch (const FormatError& error) {
    return error.what();
  }
  return "nothing was refused";
}

}  // namespace

TEST_CASE("the cheapest setting that was measured to keep an error takes its place") {
  const MeasuredOptions found = asked({.error = 0.05});
  CHECK(found.options == SolveOptions{.model = Model::diffusion, .tolerance = 0.0125, .cycles = 3});
  CHECK(found.sentence == "error 5%: kept, the bake measured 4.5% in this light with diffusion and 3 cycles");
  CHECK(asked({.error = 0.04}).options.model == Model::sp3);
  CHECK(asked({.error = 0.04}).options.cycles == 2);
  CHECK(asked({.error = 0.02}).options.cycles == 3);
  CHECK(asked({.model = Model::sp3, .error = 0.2}).options.cycles == 2);
  Json budget = record();
  budget["trials"][1]["share"] = 0.98;
  CHECK(asked({.error = 0.049}, scene(), budget).options.cycles == 2);
  budget["trials"][1].erase("share");
  CHECK(asked({.error = 0.049}, scene(), budget).options.cycles == 3);
  CHECK(asked({.error = 0.0502}, scene(), budget).options.cycles == 2);
}

TEST_CASE("sweeps are taken where a solve may have them") {
  Json budget = record();
  budget["trials"] = {trial("diffusion", 2, 100, 0.03, 0.04), trial("sp3", 2, 200, 0.01, 0.01, 1),
                      trial("sp3", 2, 300, 0.004, 0.004, 2)};
  const auto taken = [&](const SolveOptions& options) { return asked(options, scene(), budget); };
  CHECK_FALSE(taken({.error = 0.05, .correction = true}).options.correction);
  const MeasuredOptions one = taken({.error = 0.02, .correction = true});
  CHECK(one.options.correction);
  CHECK(one.options.sweeps == 1);
  CHECK(one.sentence.find("1% in this light with sp3 and 2 cycles, sweeps of the transport equation: 1") !=
        std::string::npos);
  CHECK(taken({.error = 0.02, .correction = true, .sweeps = 2}).options.sweeps == 2);
  CHECK(taken({.error = 0.02}).sentence ==
        "error 2%: the bake measured no less than 4% on this file: the solve's own estimate decides");
  CHECK(taken({.error = 0.02, .correction = true, .sweeps = 3}).sentence.find("other models or sweeps") !=
        std::string::npos);
  check_left({.error = 0.05, .correction = true, .sweep_seed = 1}, scene(), "sweeps of the usual points and seed");
}

TEST_CASE("a record tells of light that meets the body again where the file does") {
  check_left({.error = 0.05, .inter_reflection = false}, scene(), "inter-reflection, too");
  Json budget = record();
  budget["inter_reflection"] = false;
  for (const bool wanted : {false, true}) {
    CHECK(asked({.error = 0.05, .inter_reflection = wanted}, scene(), budget).options.cycles == 3);
  }
}

TEST_CASE("a record of an earlier version is left alone") {
  Json budget = record();
  budget.erase("inter_reflection");
  const MeasuredOptions found = asked({.error = 0.05}, scene(), budget);
  CHECK(found.options == SolveOptions{.error = 0.05});
  CHECK(found.sentence.find("bake again") != std::string::npos);
}

TEST_CASE("a record under usual lights stands for any") {
  Json usual = record();
  usual["lights_given"] = false;
  usual["lights"] = {{"usual", {"ambient:1"}}, {"sun", {"no light at all"}}};
  const MeasuredOptions found = asked({.error = 0.04}, scene(), usual);
  CHECK(found.sentence == "error 4%: kept, the bake measured 3% under 2 usual sets of lights with sp3 and 2 cycles");
}

TEST_CASE("lights are the same in any order and however they are written") {
  PresentScene other = scene();
  std::swap(other.lights[0], other.lights[1]);
  other.lights[0].direction.x = 3e-7f;
  CHECK(asked({.error = 0.05}, other).options.cycles == 3);
}

TEST_CASE("a material is the same however it is written") {
  Json budget = record();
  budget["material"] = "sigma_s_prime=1.5,sigma_a=0.01";
  PresentScene other = scene();
  other.material = "sigma_s_prime=1.5/1.5/1.5,sigma_a=0.01/0.01/0.01,pattern=none";
  CHECK(asked({.error = 0.05}, other, budget).options.cycles == 3);
  other.material = "sigma_s_prime=1.5,sigma_a=0.011";
  CHECK(asked({.error = 0.05}, other, budget).options.cycles == 0);
}

TEST_CASE("what was not measured is left to the estimate, and said to be") {
  PresentScene other = scene();
  other.material = "marble";
  check_left({.error = 0.05}, other, "skin1, not marble");
  other = scene();
  other.lights.pop_back();
  check_left({.error = 0.05}, other, "under other light");
  other.lights.push_back(parse_light("directional:0,0,-1:1.5"));
  check_left({.error = 0.05}, other, "under other light");
  other = scene();
  other.as_baked = false;
  check_left({.error = 0.05}, other, "the body at rest and without edits or a normal map");
  const std::string way = "fem with the buried source and fmg-pcg";
  check_left({.method = Method::quadgraph_fv, .error = 0.05}, scene(), way);
  check_left({.solver = SolverKind::dpcg, .error = 0.05}, scene(), way);
  check_left({.source = Source::diffuse, .error = 0.05}, scene(), way);
  check_left({.cycles = 4, .error = 0.05}, scene(), way);
  check_left({.error = 0.01}, scene(), "no less than 1.2% on this file");
  check_left({.model = Model::diffusion, .error = 0.04}, scene(), "no less than 4.5% on this file");
}

TEST_CASE("without an error, a record or levels to solve on nothing is said") {
  for (const MeasuredOptions& found : {asked({}), with_measured({.error = 0.05}, "{}", scene()),
                                       asked({.method = Method::shortest_path, .error = 0.05})}) {
    CHECK(found.sentence.empty());
    CHECK(found.options.cycles == 0);
  }
  CHECK(with_measured({}, R"({"budget": 3})", scene()).sentence.empty());
  CHECK_THROWS_AS(asked({.error = 1.5}), InputError);
}

TEST_CASE("a record that no bake wrote is refused by file, field, found and allowed") {
  const Json none;
  const std::tuple<const char*, Json, const char*> broken[] = {
      {"", 3, "/budget: found 3, allowed is an object"},
      {"", Json::array(), "/budget: found [], allowed is an object"},
      {"/material", 7, "/budget/material: found 7, allowed is a text"},
      {"/lights_given", "yes", "/budget/lights_given: found \"yes\", allowed is true or false"},
      {"/lights", "sun", "/budget/lights: found \"sun\", allowed is an object with \"given\""},
      {"/lights/given", 1, "/budget/lights/given: found 1, allowed is an array"},
      {"/lights/given/0", 1, "/budget/lights/given/0: found 1, allowed is a text"},
      {"/lights/given/0", "laser:1", "/budget/lights/given/0: light 'laser:1'"},
      {"/surface_vertices", -1, "/budget/surface_vertices: found -1, allowed is a whole number"},
      {"/surface_vertices", 501, "/budget/trials: found"},
      {"/levels", 2, "/budget/levels: found 2, allowed is an array"},
      {"/trials", none, "/budget/trials: found null, allowed is an array"},
      {"/trials", Json::array(), "/budget/trials: found [], allowed is"},
      {"/trials/1", "x", "/budget/trials/1: found \"x\", allowed is an object"},
      {"/trials/1", {{"surface_vertices", 1}}, "/budget/trials/1/levels: found nothing"},
      {"/trials/1/levels", 1.5, "/budget/trials/1/levels: found 1.5, allowed is a whole number from 1 to 16"},
      {"/trials/1/model", "auto", "/budget/trials/1/model: found \"auto\", allowed is \"diffusion\" or \"sp3\""},
      {"/trials/4/cycles", 0, "/budget/trials/4/cycles: found 0, allowed is a whole number from 1 to 256"},
      {"/trials/4/cycles", 1000000000, "/budget/trials/4/cycles: found 1000000000, allowed is"},
      {"/trials/4/sweeps", 101, "/budget/trials/4/sweeps: found 101, allowed is a whole number from 0 to 100"},
      {"/trials/4/cost", -1, "/budget/trials/4/cost: found -1, allowed is a number from 0"},
      {"/trials/4/share", 1.5, "/budget/trials/4/share: found 1.5, allowed is a number from 0 to 1"},
      {"/trials/4/errors", Json::object(), "/budget/trials/4/errors: found {}, allowed is an object"},
      {"/trials/4/errors/given", 0.1, "/budget/trials/4/errors/given: found 0.1, allowed is an object"},
      {"/trials/4/errors/given/unlit", none, "/budget/trials/4/errors/given/unlit: found null, allowed is a number"},
      {"/trials/4/errors/given/unlit", -0.1, "/budget/trials/4/errors/given/unlit: found -0.1, allowed is a number"}};
  for (const auto& [where, what, words] : broken) {
    Json budget = record();
    budget[Json::json_pointer(where)] = what;
    const std::string said = refusal(metadata(budget));
    INFO("said: " << said);
    CHECK(said.find("a.qgraph: metadata: " + std::string(words)) == 0);
  }
  for (const char* key : {"material", "lights", "lights_given", "surface_vertices", "levels", "trials"}) {
    Json budget = record();
    budget.erase(key);
    CHECK(refusal(metadata(budget)) ==
          "a.qgraph: metadata: /budget/" + std::string(key) + ": found nothing, a value is required");
  }
}

TEST_CASE("a record may be nested as deep as it likes") {
  std::string text = metadata(record());
  const std::string levels = "[500,90]";
  text.replace(text.find(levels), levels.size(), "{\"a\":" + std::string(200000, '[') + std::string(200000, ']') + "}");
  CHECK(refusal(text).find("/budget/levels: found {\"a\":[[[[") != std::string::npos);
}

TEST_CASE("a long text is shown up to a whole character") {
  Json budget = record();
  std::string text(58, 'x');
  for (int i = 0; i < 20; ++i) text += "\u00e9";
  budget["levels"] = text;
  CHECK(refusal(metadata(budget)).find(std::string(58, 'x') + "..., allowed") != std::string::npos);
  budget["levels"] = "x" + text;
  CHECK(refusal(metadata(budget)).find(std::string(59, 'x') + "..., allowed") != std::string::npos);
}
