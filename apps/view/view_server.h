// `sonarcal view` on a socket of 127.0.0.1: turns away whom apps/view/view_gate.h refuses, hands out the
// page's files, and has apps/view/view_api.h answer the rest.
#pragma once

#include <memory>
#include <string>

#include "apps/view/view_api.h"

namespace sonarcal::view {

// Of a request's body; the largest the page sends is a set of parameters.
inline constexpr std::size_t kMostViewRequestBytes = std::size_t{1} << 20;

class ViewServer {
 public:
  // `port` 0: any free one. `api` must outlive the server. Throws DataError where the port is taken.
  ViewServer(ViewApi& api, int port);
  ~ViewServer();  // stops

  // Answers from now on, in threads of its own.
  void Start();
  void Stop();

  int port() const;
  const std::string& token() const;
  std::string url() const;  // with the token behind '#', which a browser keeps to itself

 private:
  struct Http;
  std::unique_ptr<Http> http_;
};

}  // namespace sonarcal::view
