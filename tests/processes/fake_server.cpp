// Stands in for `aureole region` and `aureole gateway` in tests of `aureole play`: listens, says
// that it is ready, answers health checks, and misbehaves on demand.
//   FAKE_FOLDER   where it leaves a file <name>.<pid> while it is wanted to be found
//   FAKE_ORDERS   words like r1=die-at-start, r2=die-once-open, gateway=ignore-term, gateway=ill
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace {

std::string option(int argc, char** argv, const std::string& name) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (argv[i] == name) return argv[i + 1];
  }
  return {};
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

int listen_on(const std::string& host_and_port) {
  const auto colon = host_and_port.rfind(':');
  sockaddr_in at{};
  at.sin_family = AF_INET;
  inet_pton(AF_INET, host_and_port.substr(0, colon).c_str(), &at.sin_addr);
  at.sin_port = htons(static_cast<std::uint16_t>(std::stoi(host_and_port.substr(colon + 1))));
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  const int yes = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(fd, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 || ::listen(fd, 8) != 0) {
    std::perror("fake server");
    std::exit(1);
  }
  return fd;
}

void answer_one(int listener, const std::string& status) {
  const int link = accept(listener, nullptr, nullptr);
  if (link < 0) return;
  char request[1024];
  if (recv(link, request, sizeof request, 0) > 0) {
    const std::string answer = "HTTP/1.1 " + status + "\r\nContent-Length: 4\r\n\r\ntext";
    send(link, answer.data(), answer.size(), MSG_NOSIGNAL);
  }
  close(link);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const bool gateway = std::string(argv[1]) == "gateway";
  const std::string name = gateway ? "gateway" : "r" + option(argc, argv, "--region");
  const std::string orders = " " + environment("FAKE_ORDERS") + " ";
  const auto told_to = [&](const char* what) {
    return orders.find(" " + name + "=" + what + " ") != std::string::npos;
  };
  std::ofstream(environment("FAKE_FOLDER") + "/" + name + "." + std::to_string(getpid())) << "here";

  if (told_to("die-at-start")) {
    std::fprintf(stderr, "first of two lines\nthe lake is frozen\n");
    return 3;
  }
  if (told_to("ignore-term")) std::signal(SIGTERM, SIG_IGN);

  const int listener = listen_on(option(argc, argv, "--listen"));
  std::fprintf(stderr, "12:00:00.000 %s info: listening\n", name.c_str());
  std::printf("ready %s\n", name.c_str());
  std::fflush(stdout);
  if (told_to("die-once-open")) {
    const std::string opened = environment("FAKE_FOLDER") + "/opened.0";
    if (!std::ifstream(opened)) answer_one(listener, "200 OK");
    std::ofstream(opened) << "yes";
    return 4;
  }
  while (true) {
    answer_one(listener, told_to("ill") ? "503 Service Unavailable" : "200 OK");
  }
}
