// Wiring: timers, routes, and the order in which things start and stop.
#include "server/gateway/gateway.h"

#include <spdlog/spdlog.h>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>

#include "server/gateway/pictures/picture_maker.h"
#include "server/gateway/players/player_hub.h"
#include "server/gateway/web/api.h"
#include "server/gateway/web/http_server.h"
#include "server/gateway/web/static_files.h"
#include "server/net/world_clock.h"

namespace aureole {
namespace {

namespace asio = boost::asio;

constexpr std::int64_t frame_us = PicturePacing::interval_us;
constexpr int frames_per_status = 15;
/// Pictures for tools that may be in the works at a time; more are told to come back.
constexpr int max_tool_pictures = 4;

}  // namespace

struct Gateway::Impl {
  Impl(asio::io_context& context, const WorldDefinition& w, GatewayOptions o);

  void on_frame();
  void schedule_frame();
  void measure_rates();

  void serve(const HttpRequest& request, const HttpServer::Respond& respond);
  HttpResponse healthz() const;
  HttpResponse status();
  HttpResponse replicas();
  void draw_for_tool(const HttpRequest& request, const HttpServer::Respond& respond);

  /// Gone once this has stopped; what the io_context still holds then does nothing.
  std::shared_ptr<int> alive = std::make_shared<int>();
  const WorldDefinition& world;
  GatewayOptions options;
  SceneBuilder builder;
  StaticFiles files;
  PictureTotals totals;
  std::unique_ptr<RenderPool> pool;
  RegionSubscriber regions;
  Moments moments;
  Stage stage;
  PlayerHub hub;
  HttpServer http;
  asio::steady_timer timer;

  std::int64_t next_frame_us = 0;
  std::uint64_t frame_count = 0;
  PictureTotals totals_before;
  std::int64_t measured_us = 0;
  PictureRates rates;
  int tool_pictures = 0;
};

Gateway::Impl::Impl(asio::io_context& context, const WorldDefinition& w, GatewayOptions o)
    : world(w),
      options(std::move(o)),
      builder(w),
      files(options.web_root),
      pool(std::make_unique<RenderPool>(
          make_picture_maker_factory(builder),
          [&context, alive = std::weak_ptr<int>(alive)](std::function<void()> answer) {
            asio::post(context, [alive, answer = std::move(answer)] {
              if (!alive.expired()) answer();
            });
          })),
      regions(context, w, {options.number, options.incarnation, options.regions, options.secret},
              {.updated = [this](RegionId r) { hub.region_updated(r, monotonic_us()); },
               .changed = [this] { hub.regions_changed(monotonic_us()); },
               .rejected = [this](const std::string& why) { options.rejected(why); }}),
      moments(regions, builder, w),
      stage{builder, moments, *pool, totals},
      hub(w, regions, stage, {options.number, options.max_players}),
      http(context, {.listen = options.listen},
           {.request = [this](const HttpRequest& request,
                              HttpServer::Respond respond) { serve(request, respond); },
            .websocket =
                [this](std::shared_ptr<Connection> connection) {
                  hub.connected(std::move(connection));
                }}),
      timer(context) {}

// ---- Frames
// --------------------------------------------------------------------------------------

void Gateway::Impl::schedule_frame() {
  // Evenly spaced by the plan, not by when the last one happened to run; after a hold-up, from now.
  const std::int64_t now = monotonic_us();
  next_frame_us += frame_us;
  if (next_frame_us < now - 3 * frame_us) next_frame_us = now + frame_us;
  timer.expires_after(std::chrono::microseconds(std::max<std::int64_t>(next_frame_us - now, 0)));
  timer.async_wait(
      [this, alive_here = std::weak_ptr<int>(alive)](boost::system::error_code cancelled) {
        if (!cancelled && !alive_here.expired()) on_frame();
      });
}

void Gateway::Impl::on_frame() {
  hub.frame(next_frame_us);
  if (++frame_count % frames_per_status == 0) {
    hub.send_status(monotonic_us());
    measure_rates();
  }
  schedule_frame();
}

void Gateway::Impl::measure_rates() {
  const std::int64_t now = monotonic_us();
  if (now - measured_us < 1'000'000) return;
  const auto pictures = static_cast<double>(totals.pictures - totals_before.pictures);
  const double each = pictures > 0 ? 1 / pictures : 0;
  rates.per_s = pictures * 1e6 / static_cast<double>(now - measured_us);
  rates.render_ms = static_cast<double>(totals.render_us - totals_before.render_us) * each / 1e3;
  rates.encode_ms = static_cast<double>(totals.encode_us - totals_before.encode_us) * each / 1e3;
  rates.bytes = static_cast<double>(totals.bytes - totals_before.bytes) * each;
  totals_before = totals;
  measured_us = now;
}

// ---- Routes
// --------------------------------------------------------------------------------------

void Gateway::Impl::serve(const HttpRequest& request, const HttpServer::Respond& respond) {
  if (request.path == "/healthz") return respond(healthz());
  if (request.path == "/api/status") return respond(status());
  if (request.path.rfind("/api/", 0) == 0) {
    if (!request.from_loopback)
      return respond(plain_response(403, "This is for programs on the gateway's own machine."));
    if (request.path == "/api/replicas") return respond(replicas());
    if (request.path == "/api/frame.jpg") return draw_for_tool(request, respond);
    return respond(plain_response(404, "There is no such interface here."));
  }
  if (request.path == "/ws")
    return respond(plain_response(426, "This address speaks WebSocket only."));
  const auto file = files.load(request.path);
  if (!file) return respond(plain_response(404, "There is no such page here."));
  HttpResponse response{200, file->content_type, file->body, file->etag};
  if (request.if_none_match == file->etag) response.status = 304;
  respond(std::move(response));
}

HttpResponse Gateway::Impl::healthz() const {
  if (regions.all_complete()) return plain_response(200, "ok");
  return plain_response(503, fmt::format("missing: {}", fmt::join(regions.missing(), ", ")));
}

HttpResponse Gateway::Impl::status() {
  const std::int64_t now = monotonic_us();
  return {200,
          "application/json",
          status_json(world, regions, hub.reports(now), rates, regions.draw_us(now)),
          {}};
}

HttpResponse Gateway::Impl::replicas() {
  const SharedMoment moment = moments.at(monotonic_us());
  if (!moment) return plain_response(503, "No region has been heard yet.");
  return {200, "application/json", replicas_json(world, *moment), {}};
}

void Gateway::Impl::draw_for_tool(const HttpRequest& request, const HttpServer::Respond& respond) {
  const auto query = parse_frame_query(request.query);
  if (!query) return respond(plain_response(400, query.error().message + "."));
  const SharedMoment moment = moments.at(monotonic_us());
  if (!moment) return respond(plain_response(503, "No region has been heard yet."));
  PictureRequest picture;
  picture.scene = moments.scene(*moment, query->tinted);
  picture.view = query->view;
  picture.format = query->format;
  picture.quality = query->quality;
  const bool jpeg = query->format == PictureFormat::jpeg;
  const auto answer = [this, respond, jpeg](const Result<Picture>& made) {
    --tool_pictures;
    if (!made) return respond(plain_response(500, made.error().message));
    const auto& bytes = *made->bytes;
    std::string body(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    respond({200, jpeg ? "image/jpeg" : "image/x-portable-pixmap", std::move(body), {}});
  };
  if (tool_pictures >= max_tool_pictures || !pool->submit(std::move(picture), answer))
    return respond(plain_response(503, "Too many pictures are being drawn; please try again."));
  ++tool_pictures;
}

// ---- Life
// ----------------------------------------------------------------------------------------

Gateway::Gateway(asio::io_context& io, const WorldDefinition& world, GatewayOptions options)
    : impl_(std::make_unique<Impl>(io, world, std::move(options))) {}

Gateway::~Gateway() {
  stop();
}

Result<std::uint16_t> Gateway::start() {
  Impl& gateway = *impl_;
  const int threads = gateway.options.render_threads > 0 ? gateway.options.render_threads
                                                         : RenderPool::default_threads();
  if (auto ready = gateway.pool->start(threads); !ready) return ready.error();
  auto port = gateway.http.start();
  if (!port) return port;
  gateway.regions.start();
  gateway.next_frame_us = gateway.measured_us = monotonic_us();
  gateway.schedule_frame();
  spdlog::info("gateway {} listens on {}:{}, with {} render threads", gateway.options.number,
               gateway.options.listen.host, *port, threads);
  return port;
}

void Gateway::stop() {
  if (!impl_->alive) return;
  impl_->alive.reset();
  impl_->timer.cancel();
  impl_->http.stop();
  impl_->hub.stop();
  impl_->regions.stop();
}

}  // namespace aureole
