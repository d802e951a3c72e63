#include "engine/solve/simulation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "engine/graph/error.h"
#include "engine/graph/material.h"
#include "engine/solve/assembly.h"
#include "engine/solve/beams.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/level_upload.h"
#include "engine/solve/surface_results.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);

void check_options(const SolveOptions& options) {
  if (!(options.tolerance > 0) || !(options.tolerance < 1)) {
    throw InputError("tolerance: " + std::to_string(options.tolerance) + ", a number between 0 and 1 is wanted");
  }
}

}  // namespace

struct Simulation::Implementation {
  // Everything one method needs on one level.
  struct MethodLevel {
    std::optional<OperatorBuffers> op;
    std::optional<TransferBuffers> transfer;
  };

  vk::Context& context;
  const QuadGraph& graph;
  std::vector<LevelBuffers> levels;
  BeamBuffers beams;
  std::map<Method, std::vector<MethodLevel>> methods;  // those solved so far
  Workspace work;
  SurfaceResults results;
  std::optional<gpu::Material> material;
  bool material_evaluated = false;
  bool scaled = false;           // the scale is that of the present q
  std::optional<Method> solved;  // method of the last solve

  Implementation(vk::Context& context_in, const QuadGraph& graph_in)
      : context(context_in),
        graph(graph_in),
        levels(upload_levels(context_in, graph_in)),
        work(context_in, largest_dispatch()),
        results(context_in, levels[0]) {
    const gpu::BeamRecord lambertian = beam_along(std::nullopt);
    light({&lambertian, 1});
  }

  void light(std::span<const gpu::BeamRecord> records) { replace_beams(context, records, beams, levels); }

  static std::vector<LevelBuffers> upload_levels(vk::Context& context, const QuadGraph& graph) {
    std::vector<LevelBuffers> levels;
    for (const Level& level : graph.levels()) {
      levels.push_back(upload_level(context, level, static_cast<std::uint32_t>(levels.size())));
    }
    return levels;
  }

  std::uint64_t largest_dispatch() const {
    std::uint64_t largest = 0;
    for (const LevelBuffers& level : levels) largest = std::max<std::uint64_t>(largest, level.node_count);
    return largest;
  }

  OperatorBuffers& op(Method method, std::uint32_t level) { return *methods.at(method)[level].op; }

  // Changed irradiance or material: right-hand sides are stale.
  void unload() {
    scaled = false;
    for_each_operator([](OperatorBuffers& op) { op.loaded = false; });
  }

  template <typename Function>
  void for_each_operator(const Function& function) {
    for (auto& [method, of_method] : methods) {
      for (MethodLevel& level : of_method) {
        if (level.op) function(*level.op);
      }
    }
  }

  void create_structures(Method method) {
    auto& of_method = methods[method];
    of_method.resize(levels.size());
    const std::vector<Level>& source = graph.levels();
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
      if (of_method[i].op) continue;
      of_method[i].op.emplace(context, source[i], i, method);
      if (i + 1 < levels.size()) of_method[i].transfer.emplace(context, source[i], source[i + 1], i, method);
    }
  }

  void record_setup(const SolveOptions& options) {
    if (!material_evaluated) {
      for (const LevelBuffers& level : levels) record_material(work, level, *material);
      material_evaluated = true;
    }
    if (!scaled) record_scale(work, levels[0]);
    scaled = true;
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
      OperatorBuffers& rows = op(options.method, i);
      if (!rows.assembled) {
        record_assembly(work, levels[i], options.method, material->eta, rows);
        rows.assembled = true;
        rows.damped = false;
      }
      if (!rows.damped && options.solver == SolverKind::cascade) {
        record_damping(work, options.method, rows);
        rows.damped = true;
      }
      if (!rows.loaded) record_right_hand_side(work, levels[i], options.method, material->eta, rows);
      rows.loaded = true;
    }
  }

  void record_transfer(Method method, std::uint32_t level) {
    const OperatorBuffers& coarse = op(method, level + 1);
    const OperatorBuffers& fine = op(method, level);
    for (const auto& part : methods.at(method)[level].transfer->parts) {
      const gpu::TransferPush push{part.index.address(),
                                   part.weight.address(),
                                   coarse.x.address(),
                                   coarse.to_phi.address(),
                                   fine.to_phi.address(),
                                   fine.x.address(),
                                   fine.state.address(),
                                   part.width,
                                   part.first,
                                   part.coarse_first,
                                   part.count};
      work.recorder.dispatch(work.passes.transfer, push, part.count, "transfer",
                             part.count * (part.width * (8 + 2 * vec3_bytes) + 2 * vec3_bytes));
    }
  }

  std::vector<LevelReport> solve_levels(const SolveOptions& options) {
    std::vector<LevelReport> reports;
    for (auto i = static_cast<std::uint32_t>(levels.size()); i-- > 0;) {
      OperatorBuffers& rows = op(options.method, i);
      if (i + 1 == levels.size()) {
        work.recorder.fill(rows.x, 0);
      } else {
        record_transfer(options.method, i);
        if (i == 0) results.record_coarse(work, levels[0], options.method, material->eta, rows);
      }
      reports.push_back(solve_level(work, rows, i, options));
    }
    return reports;
  }

  SolveReport solve(const SolveOptions& options) {
    check_options(options);
    if (!material) throw InputError("solve: no material has been set");
    solved.reset();
    work.recorder.clear();
    create_structures(options.method);
    record_setup(options);
    SolveReport report;
    report.method = options.method;
    report.solver = options.solver;
    report.levels = solve_levels(options);
    results.record(work, levels[0], options.method, material->eta, op(options.method, 0));
    work.recorder.submit();
    report.energy = results.energy();
    if (levels.size() > 1) report.error = results.error();
    solved = options.method;
    return report;
  }

  Method solved_method() const {
    if (!solved) throw InputError("no solution: solve has not succeeded yet");
    return *solved;
  }
};

Simulation::Simulation(vk::Context& context, const QuadGraph& graph)
    : implementation_(std::make_unique<Implementation>(context, graph)) {}

Simulation::~Simulation() = default;

std::uint32_t Simulation::level_count() const {
  return static_cast<std::uint32_t>(implementation_->levels.size());
}

const LevelBuffers& Simulation::level(std::uint32_t level) const {
  return implementation_->levels.at(level);
}

void Simulation::set_material(const gpu::Material& material) {
  check_material(material);
  implementation_->material = material;
  implementation_->material_evaluated = false;
  implementation_->for_each_operator([](OperatorBuffers& op) { op.assembled = false; });
  implementation_->unload();
}

const gpu::Material& Simulation::material() const {
  if (!implementation_->material) throw InputError("no material has been set");
  return *implementation_->material;
}

void Simulation::set_beams(std::span<const gpu::BeamRecord> beams) {
  implementation_->light(beams);
  irradiance_changed();
}

void Simulation::set_irradiance(std::uint32_t level, std::span<const glm::vec3> q,
                                const std::optional<glm::vec3>& direction) {
  if (level >= level_count()) {
    throw InputError("level " + std::to_string(level) + " of irradiance: there are " + std::to_string(level_count()));
  }
  const gpu::BeamRecord beam = beam_along(direction);
  implementation_->light({&beam, 1});
  write_irradiance(implementation_->context, q, level, implementation_->levels[level]);
  irradiance_changed();
}

void Simulation::irradiance_changed() {
  implementation_->unload();
}

SolveReport Simulation::solve(const SolveOptions& options) {
  return implementation_->solve(options);
}

const std::vector<PassStats>& Simulation::passes() const {
  return implementation_->work.recorder.passes();
}

SurfaceField Simulation::surface_field() const {
  const Implementation& self = *implementation_;
  self.solved_method();
  const Level& level = self.graph.levels()[0];
  SurfaceField field;
  field.q = vk::download<glm::vec3>(self.context, self.levels[0].q);
  field.phi = vk::download<glm::vec3>(self.context, self.results.phi());
  field.exitance = vk::download<glm::vec3>(self.context, self.results.exitance());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::uvec3& face = level.faces[f];
    const glm::dvec3 p(level.vertices[face.x]);
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(level.vertices[face.y]) - p, glm::dvec3(level.vertices[face.z]) - p);
    field.position.push_back(level.nodes[level.tet_count() + f]);
    field.normal.push_back(glm::vec3(glm::normalize(normal)));
    field.area.push_back(static_cast<float>(0.5 * glm::length(normal)));
  }
  return field;
}

std::vector<glm::vec3> Simulation::phi() const {
  const Implementation& self = *implementation_;
  const OperatorBuffers& rows = implementation_->op(self.solved_method(), 0);
  std::vector<glm::vec3> phi = vk::download<glm::vec3>(self.context, rows.x);
  const auto to_phi = vk::download<glm::vec3>(self.context, rows.to_phi);
  const glm::vec3 scale = vk::download<gpu::Scale>(self.context, self.work.scale)[0].scale;
  for (std::size_t i = 0; i < phi.size(); ++i) phi[i] *= to_phi[i] * scale;
  return phi;
}

const vk::Buffer& Simulation::vertex_exitance() const {
  return implementation_->results.vertex_exitance();
}

}  // namespace quadgraph
