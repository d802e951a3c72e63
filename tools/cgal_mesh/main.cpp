// SPDX-License-Identifier: GPL-3.0-or-later
// quadgraph-cgal-mesh SURFACE.off STEM [--grading K] [--largest L] [--time-limit SECONDS]: writes STEM.node and
// STEM.ele. With --alpha A --offset O instead: writes STEM.off, a closed surface around what SURFACE.off has.
#include <CGAL/version.h>

#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/cgal_mesh/mesher.h"
#include "tools/cgal_mesh/wrap.h"

namespace {

using quadgraph::cgal::Options;
using quadgraph::cgal::Tets;

constexpr int kExitFailed = 1, kExitUsage = 2, kExitMemory = 3;

constexpr const char* kUsage =
    "usage: quadgraph-cgal-mesh SURFACE.off STEM [--grading K] [--largest L] [--time-limit SECONDS]\n"
    "       quadgraph-cgal-mesh SURFACE.off STEM --alpha A --offset O\n"
    "Fills a closed triangle surface with tetrahedra of size min over the surface of (K * distance + local edge\n"
    "length) and writes them as TetGen does: STEM.node, STEM.ele, indices from 0.\n"
    "  --grading K           growth of the size with depth, above 0 (default 1)\n"
    "  --largest L           no size is above it, above 0 (default: any)\n"
    "  --time-limit SECONDS  for the optimisation after refinement (default 240)\n"
    "  --alpha A             wrap triangles of any kind instead, and write STEM.off: a closed surface around them "
    "that\n"
    "                        covers holes narrower than A\n"
    "  --offset O            distance of that surface from them\n"
    "  --version             version of CGAL\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage, 3 out of memory.\n";

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

double positive(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value <= 0) {
    throw UsageError(option + ": '" + text + "' found, a number above 0 is allowed");
  }
  return value;
}

void write(const Tets& tets, const std::string& stem) {
  std::ofstream nodes(stem + ".node"), elements(stem + ".ele");
  nodes.precision(std::numeric_limits<double>::max_digits10);
  nodes << tets.vertices.size() << " 3 0 0\n";
  for (std::size_t i = 0; i < tets.vertices.size(); ++i) {
    const auto& p = tets.vertices[i];
    nodes << i << ' ' << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  }
  elements << tets.tets.size() << " 4 0\n";
  for (std::size_t i = 0; i < tets.tets.size(); ++i) {
    const auto& t = tets.tets[i];
    elements << i << ' ' << t[0] << ' ' << t[1] << ' ' << t[2] << ' ' << t[3] << '\n';
  }
  nodes.close();
  elements.close();
  if (!nodes || !elements) throw std::runtime_error(stem + ".node, " + stem + ".ele: cannot be written");
}

struct Wrap {
  double alpha = 0, offset = 0;  // 0: not given
};

// Where an option's value goes; null of other words.
double* option(Options& options, Wrap& wrap, const std::string& word) {
  if (word == "--alpha") return &wrap.alpha;
  if (word == "--offset") return &wrap.offset;
  if (word == "--grading") return &options.grading;
  if (word == "--largest") return &options.largest;
  return word == "--time-limit" ? &options.time_limit_s : nullptr;
}

int run(const std::vector<std::string>& arguments) {
  Options options;
  Wrap wrap;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (word == "--help" || word == "--version") {
      std::cout << (word == "--help" ? kUsage : CGAL_VERSION_STR "\n");
      return EXIT_SUCCESS;
    }
    if (double* value = option(options, wrap, word)) {
      if (++i == arguments.size()) throw UsageError(word + ": its value is missing");
      *value = positive(word, arguments[i]);
    } else if (word.starts_with("--")) {
      throw UsageError(word + ": unknown option");
    } else {
      names.push_back(word);
    }
  }
  if (names.size() != 2) throw UsageError("two names expected, " + std::to_string(names.size()) + " found");
  if ((wrap.alpha > 0) != (wrap.offset > 0)) throw UsageError("--alpha and --offset belong together");
  if (wrap.alpha > 0) {
    quadgraph::cgal::wrap_surface(names[0], names[1] + ".off", wrap.alpha, wrap.offset);
    return EXIT_SUCCESS;
  }
  write(quadgraph::cgal::mesh_surface(names[0], options), names[1]);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const UsageError& error) {
    std::cerr << "quadgraph-cgal-mesh: " << error.what() << '\n' << kUsage;
    return kExitUsage;
  } catch (const std::bad_alloc&) {
    std::cerr << "quadgraph-cgal-mesh: out of memory\n";
    return kExitMemory;
  } catch (const std::exception& error) {
    std::cerr << "quadgraph-cgal-mesh: " << error.what() << '\n';
    return kExitFailed;
  }
}
