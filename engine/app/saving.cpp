// What the viewer writes: scenes and pictures.
#include "engine/app/body_copy.h"
#include "engine/app/viewer.h"
#include "engine/base/error.h"
#include "engine/render/picture/metadata.h"
#include "engine/scene/scene_file.h"

namespace quadgraph {

void Viewer::save_scene() {
  try {
    if (preview_) throw InputError("the scene can be saved once the body is baked: this is a preview");
    std::filesystem::path path;
    do {
      path = saving_.stem.string() + "-" + std::to_string(++scenes_written_) + ".json";
    } while (std::filesystem::exists(path));
    Scene scene = state_.scene;
    if (saving_.copy_body) scene.body = copied_into(path.parent_path(), scene.body);
    const std::filesystem::path from_here = std::filesystem::proximate(scene.body);
    if (*from_here.begin() != "..") scene.body = from_here;  // so that the file names it by its own place
    SceneFile(scene).save(path);
    saved_ = state_.scene;
    state_.save_first = false;
    state_.say("saved: " + path.string());
  } catch (const std::exception& error) {
    state_.say(error.what(), true);
    state_.keep();  // what cannot be saved is not thrown away for that
  }
  frames_wanted_ = 3;
}

// Of the scene, whatever is on the screen now.
Picture Viewer::settled_picture() {
  measured_.frames = 0;
  remake(true);
  RenderOptions options = making_->scene.render;
  options.width = shown_part_.width;
  options.height = shown_part_.height;
  options.converge = options.time_limit = 0;
  Picture picture = engine().render(making_->scene.view, options);
  measured_.frames = 0;  // the mean of those on the screen is lost
  measured_.settled = false;
  return picture;
}

// The converged picture: the mean that the screen shows at rest, or that of one solve.
void Viewer::write_picture() {
  writing_ = true;
  const ToneOptions tone = state_.scene.tone;
  try {
    const bool at_rest = converging_ && converging_->found().steps.size() > 1;
    const Picture picture = at_rest ? converging_->picture() : settled_picture();
    const Metadata metadata = at_rest ? converging_->metadata() : engine().metadata();
    std::filesystem::path png, exr;
    do {
      png = saving_.stem.string() + "-" + std::to_string(++pictures_written_) + ".png";
      exr = png;
      exr.replace_extension(".exr");
    } while (std::filesystem::exists(png) || std::filesystem::exists(exr));
    write_png(png, picture, tone, metadata);
    write_exr(exr, picture, tone, metadata);
    state_.say("saved: " + png.string() + ", " + exr.string());
  } catch (const DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    state_.say(error.what(), true);
  }
  writing_ = false;
  making_.reset();
  frames_wanted_ = 3;
}

}  // namespace quadgraph
