#include "tools/layouts/study.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace quadgraph::layouts {
namespace {

bool changes_operator(const Layout& layout) {
  return layout.entries == ENTRIES_HALF || layout.entries == ENTRIES_MIXED || layout.entries == ENTRIES_GEOMETRY_HALF ||
         layout.entries == ENTRIES_STIFFNESS_HALF || layout.coefficients == COEFFICIENTS_EDGE;
}

// What a solution loses by a layout that changes the operator.
struct Loss {
  ExitanceError exitance;
  std::optional<double> least;
};

// The layout as far as it changes the operator.
Layout essence(const Layout& layout) {
  return {.entries = layout.entries, .coefficients = layout.coefficients, .at_vertices = layout.at_vertices};
}

// x that the smoother has something to do with.
std::vector<Field> rough(std::vector<Field> x) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = glm::dvec3(1 + 0.1 * std::sin(static_cast<double>(i))) * x[i];
  return x;
}

std::vector<Field> as_kept(const std::vector<Field>& fields, Model model, int vectors) {
  return unpack_fields(pack_fields(fields, model, vectors), fields.size(), model, vectors);
}

glm::dvec3 sum_of(std::span<const Field> fields) {
  glm::dvec3 sum{0};
  for (const Field& f : fields) sum += f.phi + f.phi2;
  return sum;
}

double largest_ratio(const glm::dvec3& difference, const glm::dvec3& whole) {
  const glm::dvec3 ratio = glm::abs(difference / whole);
  return std::max({ratio.x, ratio.y, ratio.z});
}

class Run {
 public:
  Run(vk::Context& context, const Level& level, const StudyOptions& options)
      : level_(level),
        options_(options),
        scene_(scene_of(level, options.material)),
        problem_{.method = Method::fem,
                 .source = Source::buried,
                 .model = options.model,
                 .optical = scene_.optical,
                 .eta = scene_.eta},
        body_(matrix_of(level, problem_, scene_.at_vertices)),
        light_(light_of(level, problem_)),
        solved_(solve(body_.rows, light_.b)),
        smooth_x_(normalised(solved_.x)),
        rough_x_(rough(smooth_x_)),
        b_(normalised(light_.b)),
        smooth_(context, body_, {smooth_x_, b_, smooth_x_}),
        rough_(context, body_, {rough_x_, b_, smooth_x_}),
        bodies_(repeated(body_, options.copies)),
        timed_(context, bodies_, {for_bodies(smooth_x_), for_bodies(b_), for_bodies(smooth_x_)}) {}

  Study study() {
    Study study{.options = options_,
                .rows = bodies_.count(),
                .entries = bodies_.entries(),
                .least = solved_.least.value_or(-1),
                .results = {}};
    std::vector<Variant> run;
    for (const Variant& variant : all_variants()) {
      Result& result = study.results.emplace_back();
      result.variant = variant;
      result.refused = timed_.refused(variant);
      if (result.refused.empty()) run.push_back(variant);
    }
    const std::vector<Times> times = timed_.time(run, options_.repeats);
    std::size_t next = 0;
    for (Result& result : study.results) {
      if (!result.refused.empty()) continue;
      result.times = times[next++];
      measure(result);
    }
    return study;
  }

 private:
  static bool product(const Variant& variant) {
    return variant.operation == Operation::product || variant.operation == Operation::product_dot ||
           variant.operation == Operation::product_then_dot;
  }

  // So that the largest is 1, as the solve scales its own.
  static std::vector<Field> normalised(std::vector<Field> fields) {
    double most = 0;
    for (const Field& f : fields) most = std::max(most, std::max({f.phi.x, f.phi.y, f.phi.z}));
    for (Field& f : fields) f = glm::dvec3(1 / most) * f;
    return fields;
  }

  std::vector<Field> for_bodies(const std::vector<Field>& fields) const {
    std::vector<Field> all(bodies_.count());
    const std::size_t stride = all.size() / options_.copies;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i % stride < fields.size()) all[i] = fields[i % stride];
    }
    return all;
  }

  void measure(Result& result) {
    const Variant& variant = result.variant;
    const Layout& layout = variant.layout;
    const Vectors exact{product(variant) ? smooth_x_ : rough_x_, b_, smooth_x_};
    const Vectors kept{as_kept(exact.x, options_.model, layout.vectors), as_kept(b_, options_.model, VECTORS_PACKED),
                       as_kept(exact.d, options_.model, layout.vectors)};
    const Rows rows = represented(body_, layout);
    Bench& bench = product(variant) ? smooth_ : rough_;
    const Outcome outcome = bench.run(variant);
    result.slots_per_entry = static_cast<double>(bench.slots(layout)) / static_cast<double>(body_.entries());
    bench.forget();
    const std::vector<Block>& diagonal = body_.rows.diagonal;
    const std::vector<Field> truth = exact_step(body_.rows, diagonal, variant.operation, exact);
    result.rounding = relative_difference(outcome.y, exact_step(rows, diagonal, variant.operation, kept));
    result.difference = relative_difference(outcome.y, truth);
    if (product(variant)) result.conservation = largest_ratio(sum_of(outcome.y) - sum_of(truth), sum_of(truth));
    if (!changes_operator(layout)) return;
    const Loss& loss = loss_of(layout);
    result.exitance = loss.exitance;
    result.least = loss.least;
  }

  const Loss& loss_of(const Layout& layout) {
    const auto [found, fresh] = losses_.try_emplace(essence(layout));
    if (fresh) {
      const Solved solved = solve(represented(body_, layout), light_.b);
      found->second = {exitance_error(level_, body_.boundary, light_, solved.x, solved_.x), solved.least};
    }
    return found->second;
  }

  const Level& level_;
  StudyOptions options_;
  Scene scene_;
  Problem problem_;
  Matrix body_;
  Light light_;
  Solved solved_;
  std::vector<Field> smooth_x_, rough_x_, b_;
  Bench smooth_, rough_;  // for the results, of one body
  Matrix bodies_;
  Bench timed_;
  std::map<Layout, Loss> losses_;
};

}  // namespace

std::vector<Field> exact_step(const Rows& rows, std::span<const Block> diagonal, Operation operation,
                              const Vectors& vectors) {
  const bool from_zero = operation == Operation::smooth_zero || operation == Operation::start_smooth;
  std::vector<Field> x = vectors.x, d = vectors.d;
  for (std::size_t i = 0; from_zero && i < x.size(); ++i) {
    x[i] = d[i] = glm::dvec3(step_c0) * quadgraph::solve(diagonal[i], vectors.b[i]);
  }
  std::vector<Field> y = quadgraph::apply(rows, x);
  if (operation == Operation::product || operation == Operation::product_dot ||
      operation == Operation::product_then_dot) {
    return y;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Field z = quadgraph::solve(diagonal[i], vectors.b[i] - y[i]);
    y[i] = x[i] + glm::dvec3(step_c1) * d[i] + glm::dvec3(step_c2) * z;
  }
  return y;
}

double relative_difference(std::span<const Field> a, std::span<const Field> b) {
  glm::dvec3 difference{0}, norm{0};
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += dot(a[i] - b[i], a[i] - b[i]);
    norm += dot(b[i], b[i]);
  }
  return std::sqrt((difference.x + difference.y + difference.z) / (norm.x + norm.y + norm.z));
}

Study study(vk::Context& context, const Level& level, const StudyOptions& options) {
  return Run(context, level, options).study();
}

}  // namespace quadgraph::layouts
