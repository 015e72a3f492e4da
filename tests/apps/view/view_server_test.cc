// `sonarcal view` by its socket: who is let in, and what a browser is told it may do.
#include "apps/view/view_server.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <future>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/commands/view_command.h"
#include "apps/view/view_gate.h"
#include "apps/view/view_page.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "tests/apps/tiny_world.h"
#include "tests/apps/view/view_world.h"

namespace sonarcal::view {
namespace {

using ::testing::HasSubstr;

TEST(ViewGate, LetsInOnlyItsOwn) {
  const ViewGate gate{.port = 8765, .token = "0123456789abcdef"};
  const ViewCaller page{.method = "GET", .path = "/", .host = "127.0.0.1:8765", .origin = "", .token = ""};
  EXPECT_FALSE(Refused(gate, page));
  ViewCaller caller = page;
  caller.host = "localhost:8765";
  EXPECT_FALSE(Refused(gate, caller));
  for (const char* host : {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8765", "evil.example",
                           "127.0.0.1:8765.evil", "[::1]:8765", "LOCALHOST:8765"}) {
    caller.host = host;
    EXPECT_TRUE(Refused(gate, caller)) << host;
  }
  caller = page;
  caller.origin = "http://127.0.0.1:8765";
  EXPECT_FALSE(Refused(gate, caller));
  for (const char* origin : {"http://evil.example", "null", "http://127.0.0.1:8766", "https://127.0.0.1:8765",
                             "http://127.0.0.1:8765.evil.example"}) {
    caller.origin = origin;
    EXPECT_TRUE(Refused(gate, caller)) << origin;
  }
  caller = page;
  caller.path = "/api/session";
  for (const char* token : {"", "0", "0123456789abcdeF", "0123456789abcdef0"}) {
    caller.token = token;
    EXPECT_EQ(Refused(gate, caller).value().status, 403) << token;
  }
  caller.token = "0123456789abcdef";
  EXPECT_FALSE(Refused(gate, caller));
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "PATCH", "HEAD"}) {
    caller.method = method;
    EXPECT_EQ(Refused(gate, caller).value().status, 405) << method;
  }
}

TEST(ViewGate, TokensAreLongAndDiffer) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) {
    tokens.insert(RandomToken());
    EXPECT_EQ(tokens.begin()->size(), 32U);
  }
  EXPECT_EQ(tokens.size(), 100U);
}

TEST(ViewPage, EveryFileThatThePageNamesIsServed) {
  const PageFile* page = FindPageFile("/");
  ASSERT_NE(page, nullptr);
  const std::string html(page->bytes);
  for (const PageFile& file : PageFiles()) {
    EXPECT_GT(file.bytes.size(), 100U) << file.path;
    EXPECT_EQ(file.bytes.find("https://cdn"), std::string_view::npos) << file.path;
  }
  std::size_t named = 0;
  for (std::size_t at = 0; (at = html.find("=\"/", at)) != std::string::npos; ++named) {
    at += 2;
    EXPECT_NE(FindPageFile(html.substr(at, html.find('"', at) - at)), nullptr) << html.substr(at, 20);
  }
  EXPECT_GE(named, 6U);
  std::size_t imported = 0;
  for (const PageFile& file : PageFiles()) {
    if (file.path == "/three.js") continue;
    constexpr std::string_view kFrom = " from '.";
    for (std::size_t at = 0; (at = file.bytes.find(kFrom, at)) != std::string_view::npos; ++imported) {
      at += kFrom.size();
      const std::string path(file.bytes.substr(at, file.bytes.find('\'', at) - at));
      EXPECT_NE(FindPageFile(path), nullptr) << file.path << ": " << path;
    }
  }
  EXPECT_GE(imported, 10U);
  EXPECT_EQ(FindPageFile("/../view_command.cc"), nullptr);
}

class ViewServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    commands::ViewOptions options;
    options.common = {.json = false, .quiet = true};
    options.scene = world_.scene();
    options.sonar = world_.sonar().string();
    options.params = world_.params();
    options.poses = world_.poses();
    options.rays.sampling = sim::Sampling::kBeams;
    options.rays.rays = RayGridSize{96, 200};
    session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
    api_ = std::make_unique<ViewApi>(*session_, "");
    server_ = std::make_unique<ViewServer>(*api_, 0);
    server_->Start();
  }

  httplib::Client Client() const { return httplib::Client("127.0.0.1", server_->port()); }
  httplib::Headers Token() const { return {{kViewTokenHeader, server_->token()}}; }

  testing::TinyWorld world_;
  std::unique_ptr<ViewSession> session_;
  std::unique_ptr<ViewApi> api_;
  std::unique_ptr<ViewServer> server_;
};

TEST_F(ViewServerTest, ServesThePageAndAnswersRequestsWithTheToken) {
  auto client = Client();
  const auto page = client.Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->body, HasSubstr("sonarcal"));
  const std::string policy = page->get_header_value("Content-Security-Policy");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, HasSubstr("frame-ancestors 'none'"));
  EXPECT_EQ(page->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_FALSE(page->has_header("Access-Control-Allow-Origin"));
  EXPECT_EQ(client.Get("/api/session")->status, 403);
  const auto session = client.Get("/api/session", Token());
  EXPECT_EQ(session->status, 200);
  EXPECT_EQ(session->get_header_value("Content-Type"), "application/json");
  EXPECT_EQ(session->body, api_->Answer("GET", "/api/session", {}).body);
  EXPECT_THAT(server_->url(), HasSubstr("/#" + server_->token()));
}

TEST_F(ViewServerTest, TurnsAwayForeignHostsAndOrigins) {
  for (const auto& [header, value] : {std::pair{"Host", "evil.example"},
                                      {"Host", "evil.example:8765"},
                                      {"Origin", "http://evil.example"},
                                      {"Origin", "null"}}) {
    httplib::Headers headers = Token();
    headers.emplace(header, value);
    for (const char* path : {"/", "/api/session"}) {
      const auto answer = Client().Get(path, headers);
      ASSERT_TRUE(answer);
      EXPECT_EQ(answer->status, 403) << header << ' ' << value;
    }
    EXPECT_EQ(Client().Post("/api/render", headers, "{}", "application/json")->status, 403);
  }
  EXPECT_EQ(Client().Options("/api/render")->status, 405);
  EXPECT_EQ(Client().Put("/api/render", "{}", "application/json")->status, 405);
}

TEST_F(ViewServerTest, UnknownPathsBadAndLargeBodies) {
  for (const char* path : {"/nothing", "/etc/passwd", "/../../etc/passwd", "/%2e%2e/view.js", "/view.js/"}) {
    EXPECT_EQ(Client().Get(path)->status, 404) << path;
  }
  EXPECT_EQ(Client().Get("/api/nothing", Token())->status, 404);
  EXPECT_EQ(Client().Post("/view.js", Token(), "", "text/plain")->status, 404);
  const auto bad = Client().Post("/api/render", Token(), "{\"parameters\":", "application/json");
  EXPECT_EQ(bad->status, 400);
  EXPECT_EQ(std::count(bad->body.begin(), bad->body.end(), '\n'), 0);
  EXPECT_THAT(bad->body, HasSubstr("request:1"));
  const std::string large(kMaxViewRequestBytes + 1, ' ');
  EXPECT_EQ(Client().Post("/api/render", Token(), large, "application/json")->status, 413);
  // Chunks, which do not tell how many will come.
  const auto chunked = Client().Post(
      "/api/render", Token(),
      [&](std::size_t, httplib::DataSink& sink) {
        sink.write(large.data(), large.size());
        sink.done();
        return true;
      },
      "application/json");
  EXPECT_TRUE(!chunked || chunked->status == 413);
  EXPECT_EQ(Client().Get("/")->status, 200);  // it is still there
}

// A page that any site can open must not be able to change anything by a link or a picture.
TEST_F(ViewServerTest, AGetChangesNothing) {
  for (const char* path : {"/api/render", "/api/recorded", "/api/compare", "/api/files", "/api/save",
                           "/api/fit/start", "/api/fit/stop"}) {
    const auto answer = Client().Get(path, Token());
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 404) << path;
  }
}

// A connection to the server that sends this and no more.
class Unfinished {
 public:
  Unfinished(int port, const std::string& bytes) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(write(socket_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  ~Unfinished() { close(socket_); }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

 private:
  int socket_;
};

TEST_F(ViewServerTest, UnfinishedRequestsDoNotShutThePageOut) {
  std::vector<std::unique_ptr<Unfinished>> slow;
  for (const char* bytes :
       {"", "GET / HTTP/1.1\r\nHost: 127", "POST /api/render HTTP/1.1\r\nContent-Length: 9\r\n\r\n{"}) {
    for (int i = 0; i < 30; ++i) {
      slow.push_back(std::make_unique<Unfinished>(server_->port(), bytes));
      std::this_thread::sleep_for(std::chrono::milliseconds(3));  // the queue of the socket is short
    }
  }
  auto client = Client();
  client.set_read_timeout(60);
  const auto page = client.Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
}

using ViewPageClosed = testing::ViewApiTest;

// A page starts a fit and is closed while it waits for images. Another page finds the fit and its result.
TEST_F(ViewPageClosed, AFitGoesOnForTheNextPage) {
  ViewServer server(*api_, 0);
  server.Start();
  const httplib::Headers token = {{kViewTokenHeader, server.token()}};
  const auto post = [&](const std::string& path, const std::string& body) {
    return fmt::format(
        "POST {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}: {}\r\nContent-Type: application/json\r\n"
        "Content-Length: {}\r\n\r\n{}",
        path, server.port(), kViewTokenHeader, server.token(), body.size(), body);
  };
  const nlohmann::json start = {{"state", State()}, {"starts", 1}, {"fixed", {"jitter.*"}}};
  ASSERT_EQ(httplib::Client("127.0.0.1", server.port())
                .Post("/api/fit/start", token, start.dump(), "application/json")
                ->status,
            200);
  for (int i = 0; i < 20; ++i) {
    const Unfinished closed_at_once(server.port(), post("/api/render", State().dump()));
  }
  httplib::Client next("127.0.0.1", server.port());
  nlohmann::json status;
  for (int i = 0; i < 3000; ++i) {
    const auto answer = next.Get("/api/fit", token);
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->status, 200);
    status = nlohmann::json::parse(answer->body);
    if (status["state"] != "running") break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(status["state"], "done") << status;
  EXPECT_TRUE(status["result"].contains("parameters"));
  const auto image = next.Post("/api/render", token, State().dump(), "application/json");
  ASSERT_TRUE(image);
  EXPECT_FALSE(testing::ReadFramed({image->status, {}, image->body}).data.empty());
}

TEST_F(ViewServerTest, TwoPagesAtOnceGetTheirOwnImages) {
  const nlohmann::json given =
      nlohmann::json::parse(data_io::ParametersJson(testing::TinyParameters()).dump());
  const auto state = [&](double source_level_db, int sequence) {
    nlohmann::json parameters = given;
    parameters["source_level_db"] = source_level_db;
    return nlohmann::json{{"parameters", parameters},
                          {"client", fmt::format("page {}", source_level_db)},
                          {"sequence", sequence}};
  };
  const auto images = [&](double source_level_db, int first_sequence) {
    std::vector<std::string> bodies;
    auto client = Client();
    for (int i = 0; i < 20; ++i) {
      const auto answer = client.Post("/api/render", Token(),
                                      state(source_level_db, first_sequence + i).dump(), "application/json");
      bodies.push_back(answer ? testing::ReadFramed({answer->status, {}, answer->body}).data : std::string());
    }
    return bodies;
  };
  const std::vector<std::string> quiet = images(190.0, 1);
  const std::vector<std::string> loud = images(205.0, 1);
  ASSERT_NE(quiet.front(), loud.front());
  ASSERT_FALSE(quiet.front().empty());
  auto other = std::async(std::launch::async, [&] { return images(205.0, 100); });
  EXPECT_EQ(images(190.0, 100), quiet);
  EXPECT_EQ(other.get(), loud);
}

// Poses moved on the page, saved as poses.json, and read by `convert` and `fit`.
TEST_F(ViewServerTest, PosesSetOnThePageAreReadByTheCommands) {
  const nlohmann::json state = {
      {"parameters", nlohmann::json::parse(data_io::ParametersJson(testing::TinyParameters()).dump())},
      {"poses",
       {{"1",
         {{"position_m", {1.3, -2.1, 1.4}}, {"yaw_deg", 28.0}, {"pitch_deg", -38.0}, {"roll_deg", 2.0}}}}}};
  const auto answer = Client().Post("/api/files", Token(), state.dump(), "application/json");
  ASSERT_EQ(answer->status, 200) << answer->body;
  const nlohmann::json files = nlohmann::json::parse(answer->body)["files"];
  testing::WriteFile(world_ / "moved.json", files.at("poses.json").get<std::string>());

  world_.WriteSimulated("real", true);
  const std::string poses = " --poses " + testing::Quoted(world_ / "moved.json");
  ASSERT_EQ(testing::RunSonarcal("convert -q " + testing::Quoted(world_ / "real") + poses + " --out " +
                                 testing::Quoted(world_ / "posed"))
                .status,
            0);
  const auto given = data_io::OpenRecording(world_ / "real");
  const auto posed = data_io::OpenRecording(world_ / "posed");
  const Pose moved = posed->frame_info(1).world_from_sonar.value();
  EXPECT_TRUE(moved.position_m.isApprox(Eigen::Vector3d(1.3, -2.1, 1.4), 1e-9))
      << moved.position_m.transpose();
  const Eigen::Quaterniond turned =
      RotationFromYawPitchRoll(RadFromDeg(28.0), RadFromDeg(-38.0), RadFromDeg(2.0));
  EXPECT_LT(moved.rotation.angularDistance(turned), 1e-6);
  EXPECT_TRUE(posed->frame_info(2).world_from_sonar->position_m.isApprox(
      given->frame_info(2).world_from_sonar->position_m, 1e-9));

  const auto at_start = [&](const std::string& real, const std::string& extra) {
    const auto outcome = testing::RunSonarcal(
        "fit -q --force --rays 96x200 --starts 1 --max-iterations 2 --held-out 1 --free material.box.gsab.C "
        "--real " +
        testing::Quoted(world_ / real) + " --scene " + testing::Quoted(world_.scene()) + " --params " +
        testing::Quoted(world_.params()) + " --out " + testing::Quoted(world_ / "fit") + extra);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return testing::ReadJsonFile(world_ / "fit/fit.json")["metrics_before"]["macro"];
  };
  const nlohmann::json by_poses = at_start("real", poses);
  EXPECT_EQ(by_poses, at_start("posed", ""));
  EXPECT_NE(by_poses, at_start("real", ""));
}

TEST_F(ViewServerTest, ASecondServerOnThePortIsRefused) {
  EXPECT_THROW(ViewServer(*api_, server_->port()), DataError);
  const int port = server_->port();
  server_->Stop();
  EXPECT_FALSE(Client().Get("/"));
  ViewServer again(*api_, port);
  again.Start();
  EXPECT_EQ(httplib::Client("127.0.0.1", port).Get("/")->status, 200);
}

// The program as a user has it: the address on stdout, an end by Ctrl-C.
TEST(ViewCommand, PrintsItsAddressAndEndsByCtrlC) {
  const testing::TinyWorld world;
  int out[2] = {};
  ASSERT_EQ(pipe(out), 0);
  const std::string scene = world.scene().string();
  const std::string sonar = world.sonar().string();
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGINT, SIG_DFL);  // a test in the background may have inherited it as ignored
    dup2(out[1], STDOUT_FILENO);
    close(out[0]);
    execl(SONARCAL_BINARY, "sonarcal", "view", "--scene", scene.c_str(), "--sonar", sonar.c_str(), "--port",
          "0", "--json", "--quiet", nullptr);
    _exit(127);
  }
  close(out[1]);
  std::string text;
  char buffer[512];
  ssize_t count = 0;
  while (text.find('}') == std::string::npos && (count = read(out[0], buffer, sizeof(buffer))) > 0) {
    text.append(buffer, static_cast<std::size_t>(count));
  }
  const nlohmann::json address = nlohmann::json::parse(text);
  EXPECT_EQ(address["host"], "127.0.0.1");
  httplib::Client client("127.0.0.1", address["port"].get<int>());
  EXPECT_EQ(client.Get("/api/session", {{kViewTokenHeader, address["token"].get<std::string>()}})->status,
            200);
  kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  close(out[0]);
}

// `timeout` ends a program that would serve the page.
TEST(ViewCommand, SettingsOfAnotherSegmentationAreRefused) {
  const testing::TinyWorld world;
  const testing::Outcome outcome =
      testing::RunSonarcal(fmt::format("view --scene {} --sonar {} --port 0 --threshold 0.3",
                                       testing::Quoted(world.scene()), testing::Quoted(world.sonar())),
                           "timeout 20");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("--threshold has no effect with --segmentation"));
}

}  // namespace
}  // namespace sonarcal::view
