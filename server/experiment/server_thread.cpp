// Taking turns by two semaphores.
#include "server/experiment/server_thread.h"

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <utility>

namespace aureole {

ServerThread::ServerThread() {
#ifdef __GLIBC__
  // By default threads share heaps when there are more than eight for each core.
  static const bool heaps_for_all = mallopt(M_ARENA_MAX, 1024) != 0;
  static_cast<void>(heaps_for_all);
#endif
  thread_ = std::thread([this] { serve(); });
}

ServerThread::~ServerThread() {
  work_ = nullptr;
  told_.release();
  thread_.join();
}

void ServerThread::run(const std::function<void()>& work) {
  work_ = &work;
  told_.release();
  done_.acquire();
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void ServerThread::serve() {
  while (true) {
    told_.acquire();
    if (work_ == nullptr) return;
    try {
      (*work_)();
    } catch (...) {
      thrown_ = std::current_exception();
    }
    done_.release();
  }
}

}  // namespace aureole
