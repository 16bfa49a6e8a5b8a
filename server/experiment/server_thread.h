// A thread for one simulated server, and with it a heap of its own.
#pragma once

#include <exception>
#include <functional>
#include <semaphore>
#include <thread>

namespace aureole {

/// Does what it is told while whoever told it waits: nothing runs at the same time. malloc gives
/// each thread its own heap, as each process has one. In a common heap bodies of all servers lie
/// between each other, and each server has to fetch more pages and lines of memory the more others
/// there are.
class ServerThread {
 public:
  ServerThread();
  ~ServerThread();
  ServerThread(const ServerThread&) = delete;
  ServerThread& operator=(const ServerThread&) = delete;

  /// Returns when it has been done; what it throws is thrown here.
  void run(const std::function<void()>& work);

 private:
  void serve();

  const std::function<void()>* work_ = nullptr;  ///< Null: the end.
  std::exception_ptr thrown_;
  std::binary_semaphore told_{0}, done_{0};
  std::thread thread_;
};

}  // namespace aureole
