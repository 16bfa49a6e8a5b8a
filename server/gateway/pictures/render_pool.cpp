// A queue, threads, and one picture for all who asked for the same.
#include "server/gateway/pictures/render_pool.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "server/base/check.h"

namespace aureole {
namespace {

bool same(const render::Camera& a, const render::Camera& b) {
  return a.eye == b.eye && a.yaw_rad == b.yaw_rad && a.pitch_rad == b.pitch_rad &&
         a.vertical_fov_rad == b.vertical_fov_rad && a.near_m == b.near_m && a.far_m == b.far_m;
}

bool same(const PictureRequest& a, const PictureRequest& b) {
  return a.scene == b.scene && a.format == b.format && a.quality == b.quality &&
         a.view.width == b.view.width && a.view.height == b.view.height &&
         a.view.show_boundaries == b.view.show_boundaries &&
         a.view.hidden_key == b.view.hidden_key && same(a.view.camera, b.view.camera);
}

}  // namespace

struct RenderPool::Shared {
  struct Job {
    PictureRequest request;
    std::vector<Answer> answers;
  };
  PictureMakerFactory factory;
  Post post;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::shared_ptr<Job>> waiting;
  std::vector<std::shared_ptr<Job>> drawing;
  std::vector<std::thread> threads;
  std::vector<Error> failures;
  int ready = 0;
  bool stopping = false;

  void run();
  void serve(PictureMaker& maker);
};

void RenderPool::Shared::run() {
  auto maker = factory();
  {
    const std::lock_guard lock(mutex);
    ++ready;
    if (!maker) failures.push_back(maker.error());
  }
  changed.notify_all();
  if (maker) serve(**maker);
}

void RenderPool::Shared::serve(PictureMaker& maker) {
  std::unique_lock lock(mutex);
  while (true) {
    changed.wait(lock, [&] { return stopping || !waiting.empty(); });
    if (stopping) return;
    std::shared_ptr<Job> job = waiting.front();
    waiting.pop_front();
    drawing.push_back(job);
    lock.unlock();

    Result<Picture> picture = maker.make(job->request);

    lock.lock();
    drawing.erase(std::find(drawing.begin(), drawing.end(), job));
    // From here on nobody can join this job, so its answers are ours alone.
    // They may hold connections: the last of the job must not die on this thread.
    post([job = std::move(job), result = std::make_shared<Result<Picture>>(std::move(picture))] {
      for (const Answer& answer : job->answers) answer(*result);
    });
  }
}

RenderPool::RenderPool(PictureMakerFactory factory, Post post)
    : shared_(std::make_unique<Shared>()) {
  shared_->factory = std::move(factory);
  shared_->post = std::move(post);
}

RenderPool::~RenderPool() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->stopping = true;
  }
  shared_->changed.notify_all();
  for (std::thread& thread : shared_->threads) thread.join();
}

Status RenderPool::start(int threads) {
  AUREOLE_CHECK(threads >= 1 && shared_->threads.empty(), "a pool is started once, with threads");
  for (int i = 0; i < threads; ++i)
    shared_->threads.emplace_back([shared = shared_.get()] { shared->run(); });
  std::unique_lock lock(shared_->mutex);
  shared_->changed.wait(lock, [&] { return shared_->ready == threads; });
  if (!shared_->failures.empty()) return shared_->failures.front();
  return Ok{};
}

bool RenderPool::submit(PictureRequest request, Answer answer) {
  {
    const std::lock_guard lock(shared_->mutex);
    const auto join = [&](const auto& jobs) {
      for (const auto& job : jobs) {
        if (!same(job->request, request)) continue;
        job->answers.push_back(std::move(answer));
        return true;
      }
      return false;
    };
    if (join(shared_->drawing) || join(shared_->waiting)) return true;
    if (shared_->waiting.size() >= max_queued) return false;
    auto job = std::make_shared<Shared::Job>();
    job->request = std::move(request);
    job->answers.push_back(std::move(answer));
    shared_->waiting.push_back(std::move(job));
  }
  shared_->changed.notify_one();
  return true;
}

int RenderPool::default_threads() {
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()) - 1, 1, 4);
}

}  // namespace aureole
