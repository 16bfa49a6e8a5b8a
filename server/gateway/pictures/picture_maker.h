// The PictureMaker of production: the renderer of this project and TurboJPEG.
#pragma once

#include "server/gateway/pictures/render_pool.h"
#include "server/gateway/pictures/scene_builder.h"

namespace aureole {

/// Must be called before the process starts its threads: it settles llvmpipe's own ones (none).
/// `builder` must outlive every maker.
PictureMakerFactory make_picture_maker_factory(const SceneBuilder& builder);

/// P6 portable pixmap of a frame.
std::vector<std::byte> to_ppm(const render::Pixels& pixels);

}  // namespace aureole
