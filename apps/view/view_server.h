// `sonarcal view` on a socket of 127.0.0.1: applies apps/view/view_gate.h, serves the files of the page, and
// passes other requests to apps/view/view_api.h.
#pragma once

#include <memory>
#include <string>

#include "apps/view/view_api.h"

namespace sonarcal::view {

// Max size of a request body. The largest that the page sends is a set of parameters.
inline constexpr std::size_t kMaxViewRequestBytes = std::size_t{1} << 20;

class ViewServer {
 public:
  // `port` 0: any free one. `api` must outlive the server. Throws DataError if the port is taken.
  ViewServer(ViewApi& api, int port);
  ~ViewServer();  // stops the server
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  // Starts answering, in its own threads.
  void Start();
  void Stop();

  int port() const;
  const std::string& token() const;
  std::string url() const;  // with the token after '#', which a browser does not send

 private:
  struct Http;
  std::unique_ptr<Http> http_;
};

}  // namespace sonarcal::view
