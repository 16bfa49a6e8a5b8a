// Keeps links to all peers: introduces, measures, hands frames on.
#include "server/net/links/peer_links.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <deque>
#include <map>

#include "protocol/wire.h"
#include "server/net/links/handshake.h"
#include "server/net/links/link.h"
#include "server/net/links/strangers.h"
#include "server/net/listener.h"
#include "server/net/rare_warning.h"

namespace aureole {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;
using namespace std::chrono_literals;

/// Links are measured often at first, so that the clock is right soon, and steadily afterwards.
constexpr auto measure_pause_first = 20ms;
constexpr auto measure_pause = 250ms;
constexpr int measure_first_count = 16;
constexpr std::size_t round_trips_kept = 16;
/// The first few may have waited for a peer that is still starting.
constexpr std::size_t round_trips_wanted = 4;
/// Each is told of everything, and may leave 64 MiB of it unread.
constexpr std::size_t gateways_max = 64;

}  // namespace

struct PeerLinks::Impl : std::enable_shared_from_this<PeerLinks::Impl> {
  struct Established {
    std::shared_ptr<Link> link;
    std::deque<std::int64_t> round_trips_us;
    std::int64_t heard_us = 0;
  };
  using DiallerPtr = std::shared_ptr<Dialler>;

  boost::asio::io_context& io;
  PeerLinksOptions options;
  WorldClock& clock;
  Events events;
  std::shared_ptr<Listener> listener;
  boost::asio::steady_timer measure_timer;
  int measured = 0;
  std::vector<DiallerPtr> diallers;
  std::map<PeerId, Established> peers;
  std::map<PeerId, Incarnation> met;
  Strangers strangers;  ///< In their handshake.
  RareWarning refusing;
  bool stopped = false;

  Impl(boost::asio::io_context& context, PeerLinksOptions o, WorldClock& c, Events e)
      : io(context),
        options(std::move(o)),
        clock(c),
        events(std::move(e)),
        measure_timer(context),
        strangers(context) {}

  bool dials(PeerId peer) const {
    return std::any_of(diallers.begin(), diallers.end(),
                       [&](const DiallerPtr& d) { return d->peer() == peer; });
  }
  bool running() const { return events.running && events.running(); }
  std::size_t gateways_linked() const {
    return static_cast<std::size_t>(std::count_if(
        peers.begin(), peers.end(), [](const auto& peer) { return !peer.first.is_region(); }));
  }
  Incarnation met_before(PeerId peer) const {
    const auto it = met.find(peer);
    return it == met.end() ? Incarnation{} : it->second;
  }

  // ---- Connecting ------------------------------------------------------------------------------

  Result<std::uint16_t> listen(const Endpoint& at) {
    listener = std::make_shared<Listener>(io, [weak = weak_from_this()](tcp::socket socket) {
      if (const auto self = weak.lock()) self->introduce(std::move(socket), nullptr);
    });
    return listener->listen(at);
  }

  void dial(const PeerAddress& address) {
    const std::weak_ptr<Impl> weak = shared_from_this();
    diallers.push_back(std::make_shared<Dialler>(
        io, address,
        Dialler::Events{
            [weak, peer = address.peer] {
              const auto self = weak.lock();
              return self && !self->peers.contains(peer);
            },
            [weak](const DiallerPtr& dialler, tcp::socket socket) {
              if (const auto self = weak.lock()) self->introduce(std::move(socket), dialler);
            },
        }));
    diallers.back()->dial();
  }

  // ---- Handshake -------------------------------------------------------------------------------

  /// Who was dialled asks for a proof, who dials says who it is, and the other answers once it
  /// knows whom it talks to.
  void introduce(tcp::socket socket, const DiallerPtr& dialler) {
    const auto link = std::make_shared<Link>(std::move(socket), options.max_queued_bytes);
    strangers.add(link, dialler != nullptr);
    auto peer = std::make_shared<std::optional<PeerId>>();
    const auto handshake =
        std::make_shared<Handshake>(dialler ? Handshake::Side::dials : Handshake::Side::answers,
                                    dialler ? dialler->peer() : options.self, options.secret);
    const std::weak_ptr<Impl> weak = shared_from_this();
    link->start({
        [weak, link = link.get(), dialler, peer, handshake](const FrameView& frame) -> Status {
          const auto self = weak.lock();
          if (!self || self->stopped) return Error{"stopping"};
          if (*peer && frame.type == FrameType::sealed)
            return self->take_sealed(**peer, *handshake, frame);
          if (*peer) return self->take(**peer, frame);
          if (dialler && !handshake->has_heard_challenge()) {
            self->answer_challenge(link->shared_from_this(), dialler, *handshake, frame);
            return Ok{};
          }
          self->strangers.note_spoken(link);
          self->meet(link->shared_from_this(), dialler, *handshake, frame, *peer);
          return Ok{};
        },
        [weak, link = link.get(), dialler, peer](const std::string& reason) {
          if (const auto self = weak.lock(); self && !self->stopped)
            self->ended(link, *peer, dialler, reason);
        },
    });
    if (!dialler) link->send(handshake->challenge());
  }

  /// What is wrong is said to the other side, and the link closed.
  void refuse(const std::shared_ptr<Link>& link, const DiallerPtr& dialler,
              const Handshake& handshake, const Refusal& refusal) {
    refusing.say(fmt::format("refused the server at {}: {}", link->remote(), refusal.reason));
    if (dialler) dialler->note_refused();
    link->close_after(handshake.seal(make_refusal(refusal)), refusal.reason);
  }

  /// Who dials and cannot agree on a secret is as good as refused.
  void refuse_proof(const std::shared_ptr<Link>& link, const DiallerPtr& dialler,
                    const Handshake& handshake, const std::string& why) {
    refuse(link, dialler, handshake, {why});
    if (dialler && events.refused) events.refused(dialler->peer(), {why, false, true});
  }

  void answer_challenge(const std::shared_ptr<Link>& link, const DiallerPtr& dialler,
                        Handshake& handshake, const FrameView& frame) {
    if (const auto heard = handshake.hear_challenge(frame); !heard)
      return refuse_proof(link, dialler, handshake, heard.error().message);
    link->send(handshake.seal(make_hello(options, met_before(dialler->peer()), running())));
  }

  /// Judges the other side's hello; sets `known`, or closes the link.
  void meet(const std::shared_ptr<Link>& link, const DiallerPtr& dialler, Handshake& handshake,
            const FrameView& frame, std::optional<PeerId>& known) {
    const auto opened = handshake.open(frame);
    if (!opened) return refuse_proof(link, dialler, handshake, opened.error().message);
    if (opened->frame.type == FrameType::refusal) {
      Refusal refusal = read_refusal(opened->frame);
      refusal.replaced &= opened->is_proven;
      if (dialler) {
        dialler->note_refused();
        if (events.refused) events.refused(dialler->peer(), refusal);
      }
      return link->close("it refused us: " + refusal.reason);
    }
    auto introduction = opened->frame.type == FrameType::hello
                            ? read_hello(opened->frame, options)
                            : Result<Introduction>(Error{"the first message is no hello"});
    if (introduction && dialler && introduction->peer != dialler->peer())
      introduction = Error::format("{} answered where {} was expected: check the addresses",
                                   describe(introduction->peer), describe(dialler->peer()));
    // Else a stranger under that name would take the place of the link that we keep up.
    if (introduction && !dialler && dials(introduction->peer))
      introduction =
          Error::format("{} is dialled from here and does not dial", describe(introduction->peer));
    if (introduction && !introduction->peer.is_region() && !peers.contains(introduction->peer) &&
        gateways_linked() >= gateways_max)
      introduction = Error::format("{} gateways are linked already", gateways_max);
    if (!introduction) return refuse(link, dialler, handshake, {introduction.error().message});
    const PeerId peer = introduction->peer;
    if (introduction->hello.incarnation < met_before(peer))
      return refuse(link, dialler, handshake,
                    {fmt::format("a newer start of {} is known", describe(peer)), true});
    if (!dialler) link->send(handshake.seal(make_hello(options, met_before(peer), running())));
    if (dialler) dialler->note_met();
    known = peer;
    establish(peer, link, introduction->hello);
  }

  void establish(PeerId peer, const std::shared_ptr<Link>& link, const PeerHello& hello) {
    strangers.remove(link.get());
    link->allow_payload(max_payload_bytes);
    // A peer that comes again has lost the old link, whatever we think of it.
    if (auto old = peers.find(peer); old != peers.end()) {
      const auto replaced = old->second.link;
      replaced->close("it has connected anew");
    }
    met[peer] = hello.incarnation;
    peers[peer] = {link, {}, monotonic_us()};
    measured = 0;
    measure_timer.cancel();
    measure();
    spdlog::info("linked with {} at {}", describe(peer), link->remote());
    events.up(peer, hello);
  }

  void ended(Link* link, std::optional<PeerId> peer, const DiallerPtr& dialler,
             const std::string& reason) {
    strangers.remove(link);
    if (peer) {
      const auto it = peers.find(*peer);
      if (it != peers.end() && it->second.link.get() == link) {
        peers.erase(it);
        spdlog::warn("lost {}: {}", describe(*peer), reason);
        events.down(*peer, reason);
      }
    }
    if (dialler) dialler->dial_later(reason);
  }

  // ---- Established -----------------------------------------------------------------------------

  std::optional<PeerId> reference() const {
    // Ascending: the first region is the one with the lowest id.
    if (peers.empty() || !peers.begin()->first.is_region()) return {};
    const PeerId lowest = peers.begin()->first;
    if (options.self.is_region() && options.self < lowest) return {};
    return lowest;
  }

  /// Whoever dialled us judges us after we have taken the link for good.
  Status take_refusal(PeerId peer, const FrameView& frame, bool is_proven) {
    Refusal refusal = read_refusal(frame);
    refusal.replaced &= is_proven;
    if (events.refused) events.refused(peer, refusal);
    return Error{"it refused us: " + refusal.reason};
  }

  Status take_sealed(PeerId peer, Handshake& handshake, const FrameView& frame) {
    const auto opened = handshake.open(frame);
    if (!opened) return opened.error();
    if (opened->frame.type != FrameType::refusal) return Error{"a second hello on one link"};
    return take_refusal(peer, opened->frame, opened->is_proven);
  }

  Status take(PeerId peer, const FrameView& frame) {
    peers.at(peer).heard_us = monotonic_us();
    switch (frame.type) {
      case FrameType::time_request: {
        const auto* request = verified<wire::TimeRequest>(frame.payload);
        if (request == nullptr) return Error{"a time request is not a valid message"};
        const auto world = clock.world_us(monotonic_us());
        flatbuffers::FlatBufferBuilder builder(64);
        send(peer, std::make_shared<const Bytes>(finish_frame(
                       builder,
                       wire::CreateTimeReply(builder, request->sent_us(), world.value_or(0),
                                             world.has_value() && running()),
                       FrameType::time_reply)));
        return Ok{};
      }
      case FrameType::time_reply: {
        const auto* reply = verified<wire::TimeReply>(frame.payload);
        if (reply == nullptr) return Error{"a time reply is not a valid message"};
        const std::int64_t heard = monotonic_us();
        if (reply->sent_us() > heard || reply->sent_us() < heard - 60'000'000)
          return Error{"a time reply to a question that was not asked"};
        auto& trips = peers.at(peer).round_trips_us;
        trips.push_back(heard - reply->sent_us());
        if (trips.size() > round_trips_kept) trips.pop_front();
        // World time stays below 2^53 µs (285 years), whatever a peer says.
        const bool sane = reply->world_us() >= 0 && reply->world_us() < (std::int64_t{1} << 53);
        // Whoever joins a world that runs has the time from anybody who runs, and follows the
        // reference from then on; so does region 0, which is nobody's follower.
        const bool counts = reference() == peer || (!clock.is_set() && peer.is_region());
        if (reply->running() && sane && counts)
          clock.add_sample(reply->sent_us(), reply->world_us(), heard);
        if (events.measured && trips.size() >= round_trips_wanted) events.measured(peer);
        return Ok{};
      }
      case FrameType::hello:
        return Error{"a second hello on one link"};
      case FrameType::refusal:
        return take_refusal(peer, frame, !options.secret);
      default:
        return events.frame(peer, frame);
    }
  }

  void measure() {
    if (stopped) return;
    std::vector<std::shared_ptr<Link>> links;  // Sending may close a link and change the map.
    std::vector<std::shared_ptr<Link>> silent;
    for (const auto& [peer, established] : peers) {
      const bool is_silent = monotonic_us() - established.heard_us > options.silence_us;
      (is_silent ? silent : links).push_back(established.link);
    }
    for (const auto& link : silent)
      link->close(fmt::format("it has said nothing for {} s", options.silence_us / 1'000'000));
    for (const auto& link : links) {
      flatbuffers::FlatBufferBuilder builder(64);
      link->send(std::make_shared<const Bytes>(finish_frame(
          builder, wire::CreateTimeRequest(builder, monotonic_us()), FrameType::time_request)));
    }
    measure_timer.expires_after(measured++ < measure_first_count ? measure_pause_first
                                                                 : measure_pause);
    measure_timer.async_wait([weak = weak_from_this()](const error_code& ec) {
      if (ec) return;
      if (const auto self = weak.lock()) self->measure();
    });
  }

  void send(PeerId to, SharedBytes frame) {
    const auto it = peers.find(to);
    if (it == peers.end()) return;
    // Sending can close the link and with it erase our entry.
    const auto link = it->second.link;
    link->send(std::move(frame));
  }

  void stop() {
    if (stopped) return;
    stopped = true;
    if (listener) listener->stop();
    measure_timer.cancel();
    for (const auto& dialler : diallers) dialler->stop();
    for (const auto& [peer, established] : std::map(peers)) established.link->close("stopping");
    strangers.close_all("stopping");
    peers.clear();
  }
};

PeerLinks::PeerLinks(boost::asio::io_context& io, PeerLinksOptions options, WorldClock& clock,
                     Events events)
    : impl_(std::make_shared<Impl>(io, std::move(options), clock, std::move(events))) {}

PeerLinks::~PeerLinks() {
  impl_->stop();
}

Result<std::uint16_t> PeerLinks::listen(const Endpoint& at) {
  return impl_->listen(at);
}

void PeerLinks::start() {
  for (const auto& address : impl_->options.dial) impl_->dial(address);
}

void PeerLinks::stop() {
  impl_->stop();
}

void PeerLinks::send(PeerId to, SharedBytes frame) {
  impl_->send(to, std::move(frame));
}

bool PeerLinks::is_linked(PeerId peer) const {
  return impl_->peers.contains(peer);
}

std::int64_t PeerLinks::round_trip_us(PeerId peer) const {
  const auto it = impl_->peers.find(peer);
  if (it == impl_->peers.end() || it->second.round_trips_us.empty()) return 0;
  return *std::min_element(it->second.round_trips_us.begin(), it->second.round_trips_us.end());
}

}  // namespace aureole
