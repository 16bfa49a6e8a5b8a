// Threads that turn scenes into pictures, so that drawing never holds up the network.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "renderer/scene.h"
#include "server/base/result.h"

namespace aureole {

enum class PictureFormat : std::uint8_t {
  jpeg,
  ppm,  ///< Lossless: P6, 8 bits for each of red, green and blue.
};

using SharedScene = std::shared_ptr<const render::Scene>;
using SharedPictureBytes = std::shared_ptr<const std::vector<std::byte>>;

struct PictureRequest {
  SharedScene scene;
  render::View view;
  PictureFormat format = PictureFormat::jpeg;
  int quality = 80;  ///< 1 … 100, for JPEG.
};

struct Picture {
  SharedPictureBytes bytes;
  std::uint32_t render_us = 0;
  std::uint32_t encode_us = 0;
};

/// Whatever draws; made, used and destroyed by one thread.
class PictureMaker {
 public:
  PictureMaker() = default;
  PictureMaker(const PictureMaker&) = delete;
  PictureMaker& operator=(const PictureMaker&) = delete;
  virtual ~PictureMaker() = default;
  virtual Result<Picture> make(const PictureRequest& request) = 0;
};

/// Called once on each thread of the pool.
using PictureMakerFactory = std::function<Result<std::unique_ptr<PictureMaker>>()>;

/// Requests are served in order. Equal requests (same scene object, view, format and quality) that
/// have not been answered yet are drawn once. All functions are called from one thread; answers
/// come through `post`, which must bring a function to that thread and may be called from any.
class RenderPool {
 public:
  using Post = std::function<void(std::function<void()>)>;
  using Answer = std::function<void(const Result<Picture>&)>;

  RenderPool(PictureMakerFactory factory, Post post);
  /// Ends the threads after the pictures in the works; requests that wait are dropped unanswered.
  ~RenderPool();

  /// Starts `threads` (≥ 1) and waits until each has its own PictureMaker; the first Error of any.
  Status start(int threads);
  /// Queues a request. False if `max_queued` wait already: the caller draws later.
  [[nodiscard]] bool submit(PictureRequest request, Answer answer);

  static constexpr std::size_t max_queued = 128;

  /// One a thread, fewer than processors, so that the network thread always finds one: 1 … 4.
  static int default_threads();

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace aureole
