#include "apps/view/view_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <chrono>
#include <thread>

#include "apps/view/view_gate.h"
#include "apps/view/view_page.h"
#include "core/types/error.h"

namespace sonarcal::view {
namespace {

constexpr const char* kHost = "127.0.0.1";
// A browser opens six connections. A connection that sends nothing holds a thread until the time limit.
constexpr int kThreads = 64;
constexpr int kReadLimitS = 1;

// Rights of the page in a browser: its own scripts and pictures, requests to this server, no frames.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src "
    "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// Uses a provider, so that the library does not compress data for this machine.
void Put(httplib::Response& response, int status, std::string body, const std::string& type) {
  response.status = status;
  if (body.empty()) return;
  const auto kept = std::make_shared<const std::string>(std::move(body));
  response.set_content_provider(kept->size(), type,
                                [kept](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                  return sink.write(kept->data() + offset, length);
                                });
}

void PutSentence(httplib::Response& response, int status, const std::string& sentence) {
  Put(response, status, sentence + "\n", "text/plain; charset=utf-8");
}

}  // namespace

struct ViewServer::Http {
  explicit Http(ViewApi& of) : api(of) {}

  ViewApi& api;
  httplib::Server server;
  ViewGate gate;
  std::thread thread;

  // Returns true if the caller is accepted; otherwise sends the refusal.
  bool LetIn(const httplib::Request& request, httplib::Response& response) const {
    const auto header = [&](const char* name) { return request.get_header_value(name); };
    const std::string host = header("Host");
    const std::string origin = header("Origin");
    const std::string token = header(kViewTokenHeader);
    const auto refusal = Refused(
        gate,
        {.method = request.method, .path = request.path, .host = host, .origin = origin, .token = token});
    if (refusal) PutSentence(response, refusal->status, refusal->sentence);
    return !refusal;
  }

  void Answer(const httplib::Request& request, const std::string& body, httplib::Response& response) {
    if (!LetIn(request, response)) return;
    if (!request.path.starts_with("/api/")) {
      const PageFile* file = request.method == "GET" ? FindPageFile(request.path) : nullptr;
      if (file == nullptr) return PutSentence(response, 404, "nothing is there");
      return Put(response, 200, std::string(file->bytes), std::string(file->type));
    }
    ViewAnswer answer = api.Answer(request.method, request.path, body);
    Put(response, answer.status, std::move(answer.body), answer.type);
  }

  void AnswerPost(const httplib::Request& request, httplib::Response& response,
                  const httplib::ContentReader& read) {
    std::string body;
    bool too_large = false;
    read([&](const char* bytes, std::size_t count) {
      too_large = body.size() + count > kMaxViewRequestBytes;
      if (!too_large) body.append(bytes, count);
      return !too_large;
    });
    // The library itself limits only bodies with a stated length.
    if (too_large || response.status == 413) {
      return PutSentence(response, 413,
                         fmt::format("the request has more than {} bytes", kMaxViewRequestBytes));
    }
    Answer(request, body, response);
  }

  void SetUp() {
    server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server.set_payload_max_length(kMaxViewRequestBytes);
    server.set_keep_alive_max_count(100'000);
    server.set_keep_alive_timeout(1);
    server.set_read_timeout(kReadLimitS);
    server.set_tcp_nodelay(true);
    // Allows a restart on the same port, but not two programs on one port, which is the library's default.
    server.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    server.set_default_headers({{"Content-Security-Policy", kPolicy},
                                {"X-Content-Type-Options", "nosniff"},
                                {"X-Frame-Options", "DENY"},
                                {"Referrer-Policy", "no-referrer"},
                                {"Cross-Origin-Resource-Policy", "same-origin"},
                                {"Cross-Origin-Opener-Policy", "same-origin"},
                                {"Cache-Control", "no-store"}});
    server.Get(".*", [this](const httplib::Request& request, httplib::Response& response) {
      Answer(request, {}, response);
    });
    server.Post(".*", [this](const httplib::Request& request, httplib::Response& response,
                             const httplib::ContentReader& read) { AnswerPost(request, response, read); });
    const auto refuse = [this](const httplib::Request& request, httplib::Response& response) {
      LetIn(request, response);
    };
    server.Put(".*", refuse);
    server.Patch(".*", refuse);
    server.Delete(".*", refuse);
    server.Options(".*", refuse);
  }
};

ViewServer::ViewServer(ViewApi& api, int port) : http_(std::make_unique<Http>(api)) {
  http_->SetUp();
  http_->gate.token = RandomToken();
  if (port == 0) {
    http_->gate.port = http_->server.bind_to_any_port(kHost);
    if (http_->gate.port <= 0) throw DataError("no port of {} is free", kHost);
    return;
  }
  if (!http_->server.bind_to_port(kHost, port)) {
    throw DataError(
        "port {} of {} is not available: another program may use it; choose another with --port, or 0 for "
        "any free port",
        port, kHost);
  }
  http_->gate.port = port;
}

ViewServer::~ViewServer() {
  Stop();
}

void ViewServer::Start() {
  http_->thread = std::thread([this] { http_->server.listen_after_bind(); });
  while (!http_->server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void ViewServer::Stop() {
  if (!http_->thread.joinable()) return;
  http_->server.stop();
  http_->thread.join();
}

int ViewServer::port() const {
  return http_->gate.port;
}

const std::string& ViewServer::token() const {
  return http_->gate.token;
}

std::string ViewServer::url() const {
  return fmt::format("http://{}:{}/#{}", kHost, http_->gate.port, http_->gate.token);
}

}  // namespace sonarcal::view
