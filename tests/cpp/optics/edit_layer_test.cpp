// Layers of edits, and edits with a mirror image.
#include "engine/optics/edit_layer.h"

#include <doctest/doctest.h>

#include "engine/base/error.h"

using namespace quadgraph;

namespace {

using enum EditOperation;

const gpu::Optical given{{1, 2, 3}, {0.1f, 0.2f, 0.3f}};

gpu::Optical shown(const std::vector<EditLayer>& layers, const glm::vec3& place = {}, float depth = 0) {
  return EditArrays(applied_edits(layers)).apply(given, place, depth, 1);
}

EditLayer of(std::vector<Edit> edits, float opacity = 1) {
  return {.name = "a", .opacity = opacity, .edits = std::move(edits)};
}

const Edit twice{.operation = multiply, .sigma_a = glm::vec3(2)}, plus{.operation = add, .sigma_a = glm::vec3(1)},
    five{.operation = EditOperation::set, .sigma_a = glm::vec3(5)};

// 1 at x = 0.. of a stroke that fades from 1 to 3 mm around the origin, and its image about x = 10.
Edit both_sides() {
  Edit edit{
      .operation = EditOperation::set, .sigma_a = glm::vec3(1), .stroke = {{0, 0, 0}}, .radius = 2, .softness = 2};
  edit.mirrored = EditMirror{.stroke = {{10, 0, 0}}};
  return edit;
}

}  // namespace

TEST_CASE("layers are applied in order, and hidden ones not at all") {
  const EditLayer first = of({twice}), second = of({plus});
  CHECK(shown({first, second}).sigma_a.x == doctest::Approx(1.2f));
  CHECK(shown({second, first}).sigma_a.x == doctest::Approx(2.2f));
  EditLayer hidden = second;
  hidden.visible = false;
  CHECK(shown({first, hidden}).sigma_a.x == doctest::Approx(0.2f));
  CHECK(applied_edits(std::vector{first, hidden}) == applied_edits(std::vector{first}));
  CHECK(applied_edits(std::vector{of({plus}, 0), of({})}).empty());
}

TEST_CASE("an opaque layer is its edits, and one edit of an opacity is that edit as weak") {
  CHECK(applied_edits(std::vector{of({twice})}) == std::vector{twice});
  const float share = 0.25f, own = given.sigma_a.x;
  CHECK(shown({of({twice}, share)}).sigma_a.x == doctest::Approx(own * (1 + (2 - 1) * share)));
  CHECK(shown({of({plus}, share)}).sigma_a.x == doctest::Approx(own + share * 1));
  CHECK(shown({of({five}, share)}).sigma_a.x == doctest::Approx(own + share * (5 - own)));
  CHECK(shown({of({five}, share)}).sigma_s_prime == given.sigma_s_prime);
}

TEST_CASE("strokes that overlap in a layer are together no more than its opacity") {
  const float share = 0.5f, own = given.sigma_a.x;
  CHECK(shown({of({five, five, five}, share)}).sigma_a.x == doctest::Approx(own + share * (5 - own)));
  // Each layer is mixed with what is below it.
  const float below = own + share * (2 * own - own);
  CHECK(shown({of({twice}, share), of({plus, five}, share)}).sigma_a.x == doctest::Approx(below + share * (5 - below)));
}

TEST_CASE("an edit with a mirror image is at both places, and no more than once where they meet") {
  Edit edit = both_sides();
  check_edit(edit);
  const auto at = [&](float x) { return shown({of({edit})}, {x, 0, 0}).sigma_a.x; };
  for (const float x : {-2.0f, -1.5f, 0.0f, 1.2f, 4.0f}) CHECK(at(x) == doctest::Approx(at(10 - x)));
  CHECK(at(0) == 1);
  CHECK(at(5) == given.sigma_a.x);
  edit.operation = add;
  edit.mirrored->stroke = {{0.5f, 0, 0}};
  CHECK(at(0.25f) == doctest::Approx(given.sigma_a.x + 1));
}

TEST_CASE("the mirror image of a picture is seen in the mirror") {
  Image image{2, 1, {glm::vec3(0), glm::vec3(1)}};  // dark on the left
  Edit edit{.operation = EditOperation::set, .sigma_a = glm::vec3(1)};
  edit.placement = Placement{.centre = {-5, 0, 0}, .size = {4, 4, 4}};
  edit.image = std::make_shared<const ImagePyramid>(pyramid_of(image, 1024));
  edit.mirrored = EditMirror{.placement = Placement{.centre = {5, 0, 0}, .size = {4, 4, 4}}};
  check_edit(edit);
  const auto at = [&](float x) { return shown({of({edit})}, {x, 0, 0}).sigma_a.x; };
  CHECK(at(-6.8f) == doctest::Approx(0));
  CHECK(at(-3.2f) == doctest::Approx(1));
  for (const float x : {3.2f, 4.4f, 5.0f, 5.7f, 6.8f}) CHECK(at(x) == doctest::Approx(at(-x)));
}

TEST_CASE("a mirror image unlike its edit, and a layer without a name, are refused by their fields") {
  Edit edit = both_sides();
  edit.mirrored->stroke.emplace_back(0, 0, 1);
  CHECK_THROWS_WITH_AS(check_edit(edit), doctest::Contains("mirrored: stroke: found 2"), InputError);
  edit.mirrored->stroke = {{0, NAN, 0}};
  CHECK_THROWS_WITH_AS(check_edit(edit), doctest::Contains("mirrored: stroke: found nan"), InputError);
  edit = both_sides();
  edit.mirrored->placement = Placement{.size = glm::vec3(1)};
  CHECK_THROWS_WITH_AS(check_edit(edit), doctest::Contains("mirrored: placement: found one"), InputError);
  edit.placement = edit.mirrored->placement;
  CHECK_NOTHROW(check_edit(edit));
  edit.mirrored->placement->size.x = 0;
  CHECK_THROWS_WITH_AS(check_edit(edit), doctest::Contains("mirrored: placement: size: found 0"), InputError);
  edit = five;
  edit.mirrored.emplace();
  CHECK_THROWS_WITH_AS(check_edit(edit), doctest::Contains("mirrored: found, an edit everywhere"), InputError);

  CHECK_NOTHROW(check_layer({.name = "Veins, \xc3\xa4"}));
  CHECK_THROWS_WITH_AS(check_layer({.name = ""}), doctest::Contains("name: found 0 bytes"), InputError);
  CHECK_THROWS_AS(check_layer({.name = std::string(longest_layer_name + 1, 'a')}), InputError);
  CHECK_THROWS_WITH_AS(check_layer({.name = "a\nb"}), doctest::Contains("control character"), InputError);
  CHECK_THROWS_WITH_AS(check_layer({.name = "a", .opacity = NAN}), doctest::Contains("opacity: found nan"), InputError);
}
