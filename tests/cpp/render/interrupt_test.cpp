// Work of the device that is given up half-way, and what an engine answers after it.
#include <doctest/doctest.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/deform/deformer.h"
#include "engine/render/engine.h"
#include "tests/cpp/fixtures/engine_work.h"
#include "tests/cpp/fixtures/test_data.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

struct GivenUp {};

// An engine on a body, whose device asks between all pieces of work whether to go on.
class Impatient {
 public:
  explicit Impatient(const std::filesystem::path& file) : engine(file, asking()) {
    engine.set_lights({parse_light("directional:0,0.2,-1:1/2/3"), parse_light("ambient:0.3")});
  }
  ~Impatient() {
    for (const auto& message : engine.device().validation_messages()) FAIL_CHECK(message);
  }
  Impatient(const Impatient&) = delete;
  Impatient& operator=(const Impatient&) = delete;

  // Whether `work` was given up, as the device asked for the time `number`, from 1; with fewer questions it is not.
  template <typename Work>
  bool gives_up(const Work& work, std::uint64_t number) {
    asked = 0;
    last = number;
    bool given_up = false;
    try {
      work();
    } catch (const GivenUp&) {
      given_up = true;
    }
    last = never;
    return given_up;
  }

 private:
  device::DeviceOptions asking() {
    device::DeviceOptions options = test_device();
    options.pause = std::chrono::milliseconds(0);
    options.check = [this] {
      if (++asked >= last) throw GivenUp();
    };
    return options;
  }

  std::uint64_t last = never;

 public:
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t asked = 0;
  Engine engine;
};

// A handful of numbers of [1, count], denser at the beginning, and the last one.
std::vector<std::uint64_t> some_of(std::uint64_t count) {
  std::vector<std::uint64_t> numbers;
  for (double k = 1; k < static_cast<double>(count); k = 2.5 * k + 1) numbers.push_back(static_cast<std::uint64_t>(k));
  numbers.push_back(count);
  return numbers;
}

struct Answer {
  std::vector<glm::vec3> exitance{};
  std::vector<float> scattered{}, specular{}, alpha{};
  glm::dvec3 entered{}, absorbed{};

  bool operator==(const Answer&) const = default;
};

const RenderOptions small{.width = 12, .height = 9}, on_ground{.width = 12, .height = 9, .ground = true};

Answer answer(Engine& engine, const SolveOptions& options, const RenderOptions& render = small) {
  const SolveReport report = engine.solve(options);
  const Picture picture = engine.render(View{}, render);
  Answer found{.scattered = picture.scattered, .specular = picture.specular, .alpha = picture.alpha};
  if (report.path) return found;
  found.exitance = engine.surface_field().exitance;
  found.entered = report.energy.entered;
  found.absorbed = report.energy.absorbed;
  return found;
}

// The solution is lost with what was given up, but where that was the error of its picture.
std::optional<Picture> picture_of_what_is_left(Engine& engine, const RenderOptions& render) {
  try {
    return engine.render(View{}, render);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

struct Way {
  SolveOptions options;
  bool bent = false;
  const char* file = "tiny.qgraph";
  bool ground = false;
};

std::vector<Way> ways() {
  const SolverKind solver = SolverKind::dpcg;
  const SolveOptions corrected{.solver = solver, .correction = true, .sweeps = 1, .sweep_points = 300};
  return {{.options = corrected, .ground = true},
          {corrected, true},
          {{.method = Method::fem, .solver = SolverKind::fmg_pcg, .model = Model::sp3}},
          {{.method = Method::quadgraph_fv, .solver = solver}, true},
          {{.method = Method::quadgraph_fv, .solver = solver}, false, "polygrid.qgraph"},  // of several workgroups
          {{.method = Method::shortest_path, .path = {.cells = 16}}}};
}

void bend(Engine& engine) {
  engine.set_deformation(std::vector{Deformer{.degrees = 20}});
}

}  // namespace

TEST_CASE("a solve or picture that is given up at any piece of its work leaves an engine that answers as a new one") {
  for (const Way& way : ways()) {
    const SolveOptions& options = way.options;
    const bool bent = way.bent;
    const RenderOptions& look = way.ground ? on_ground : small;
    CAPTURE(name_of(options.method));
    CAPTURE(bent);
    CAPTURE(std::string(way.file));
    Impatient fresh(test_data(way.file));
    fresh.engine.set_material("sigma_s_prime=2/1.5/1,sigma_a=0.1/.02/.01,eta=1.4");
    if (bent) bend(fresh.engine);
    fresh.asked = 0;
    const Answer expected = answer(fresh.engine, options, look);
    const std::uint64_t count = fresh.asked;
    CHECK(count > 20);
    Impatient tried(test_data(way.file));
    tried.engine.set_material("sigma_s_prime=1,sigma_a=0.2,eta=1.3");
    answer(tried.engine, options, look);
    tried.engine.set_material("sigma_s_prime=2/1.5/1,sigma_a=0.1/.02/.01,eta=1.4");
    if (bent) bend(tried.engine);
    int given_up = 0;
    for (const std::uint64_t number : some_of(count)) {
      CAPTURE(number);
      if (!tried.gives_up([&] { answer(tried.engine, options, look); }, number)) continue;
      ++given_up;
      const auto kept = picture_of_what_is_left(tried.engine, look);
      if (kept) CHECK(kept->scattered == expected.scattered);
      CHECK((answer(tried.engine, options, look) == expected));
    }
    const bool gpu = !tried.engine.device().info().cpu;  // asks less often: not between the parts of a pass
    CHECK(given_up >= (gpu ? 2 : 3));
  }
}

TEST_CASE("an engine whose light or first work is given up at any piece of it answers as a new one, below a sky, too") {
  const WorkFolder folder;
  const std::string file = folder.slabs();
  const std::vector lights{parse_light("ambient:0.3"), parse_light("environment:" + folder.sky() + ":20:2")};
  const SolveOptions options{.solver = SolverKind::dpcg};
  const auto look = [&](Engine& engine) { return answer(engine, options); };
  const auto prepare = [&](Engine& engine) {
    engine.set_material("sigma_s_prime=2/1.5/1,sigma_a=0.1/.02/.01,eta=1.4");
    engine.set_lights(lights);
    bend(engine);
  };
  Impatient fresh(file), changed(file);
  prepare(fresh.engine);
  const Answer expected = look(fresh.engine);
  for (std::uint64_t number = 1; number <= 100; number += 7) {
    CAPTURE(number);
    Impatient tried(file);
    prepare(tried.engine);
    CHECK(tried.gives_up([&] { look(tried.engine); }, number));
    CHECK((look(tried.engine) == expected));
    changed.engine.set_material("sigma_s_prime=1,sigma_a=0.2,eta=1.3");
    changed.engine.set_lights({parse_light("point:4,2,1:20")});
    look(changed.engine);
    prepare(changed.engine);
    CHECK(changed.gives_up([&] { look(changed.engine); }, number));
    CHECK((look(changed.engine) == expected));
  }
}

TEST_CASE("light that entered again in a solve before is not in the one after a solve that was given up") {
  const WorkFolder folder;
  const std::string material = "sigma_s_prime=2/1.5/1,sigma_a=0.1/.02/.01,eta=1.4";
  const SolveOptions options{.solver = SolverKind::dpcg};
  Impatient fresh(folder.slabs()), tried(folder.slabs());
  fresh.engine.set_material(material);
  const Answer expected = answer(fresh.engine, options);
  CHECK(glm::length(fresh.engine.solve(options).energy.re_entered) > 0);
  tried.engine.set_material(material);
  answer(tried.engine, options);
  for (std::uint64_t number = 1; number <= 24; ++number) {
    CAPTURE(number);
    tried.engine.set_material(material);  // so that there is work before the light
    tried.gives_up([&] { tried.engine.solve(options); }, number);
    CHECK((answer(tried.engine, options) == expected));
  }
}
