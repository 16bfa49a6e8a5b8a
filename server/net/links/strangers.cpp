// Deadlines, and room for who comes.
#include "server/net/links/strangers.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace aureole {

void Strangers::add(const std::shared_ptr<Link>& link, bool dialled) {
  if (!dialled) make_room();
  const auto stranger = std::make_shared<Stranger>(
      Stranger{link, dialled, boost::asio::steady_timer(io_, time_to_speak)});
  strangers_.push_back(stranger);
  stranger->deadline.async_wait(
      [weak = std::weak_ptr(stranger)](const boost::system::error_code& cancelled) {
        const auto self = weak.lock();
        if (cancelled || !self || self->spoken) return;
        self->link->close("it did not introduce itself in time");
      });
}

void Strangers::make_room() {
  const auto waits = [](const auto& stranger) { return !stranger->dialled; };
  const auto waiting = std::count_if(strangers_.begin(), strangers_.end(), waits);
  if (static_cast<std::size_t>(waiting) < accepted_max) return;
  crowded_.say(fmt::format("{} connections have not said who they are yet; the oldest is closed",
                           waiting));
  // Held: closing it takes it off the list.
  const auto oldest = *std::find_if(strangers_.begin(), strangers_.end(), waits);
  oldest->link->close("it did not introduce itself before many others came");
}

void Strangers::note_spoken(const Link* link) {
  for (const auto& stranger : strangers_)
    if (stranger->link.get() == link) stranger->spoken = true;
}

void Strangers::remove(const Link* link) {
  std::erase_if(strangers_, [&](const auto& stranger) { return stranger->link.get() == link; });
}

void Strangers::close_all(const std::string& reason) {
  for (const auto& stranger : std::exchange(strangers_, {})) stranger->link->close(reason);
}

}  // namespace aureole
