// Requests of the page of `sonarcal view` and their answers, without a socket:
//
//   GET  /api/session       names, axes, controls, poses, colours; JSON
//   GET  /api/scene         the mesh; framed
//   POST /api/render        STATE -> the simulated image; framed, or 204 if the same client has sent a newer
//                           request meanwhile
//   POST /api/recorded      {"frame"} -> a recorded frame; framed
//   POST /api/compare       STATE -> figures as in the frames of metrics.json, and the object regions; framed
//   POST /api/files         STATE -> {"files": {"params.json": text, ...}, "command"}; JSON
//   POST /api/save          STATE -> as /api/files, written into --out; JSON
//   POST /api/fit/start     {"state": STATE, "starts": 4, ...}, see kPageOptions -> status; JSON
//   POST /api/fit/stop      {} -> status; JSON
//   GET  /api/fit           status (apps/view/view_fit.h); JSON
//
// STATE is that of apps/view/view_state.h. A framed answer is a little-endian number of four bytes, as many
// bytes of JSON, and the data that the JSON describes. An image is grey values, range bins x beams, nearest
// first, of one or two (little-endian) bytes each. The mesh is {vertices x 3 floats, triangles x 3 numbers of
// four bytes, materials of two bytes}, each part aligned to four bytes. A failed request gets {"error":
// sentence} with status 400 (not a valid request), 404 (not found) or 422 (the result cannot be made).
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

#include "apps/view/view_fit.h"
#include "apps/view/view_session.h"

namespace sonarcal::view {

struct ViewAnswer {
  int status = 200;
  std::string type;  // MIME; empty with an empty body
  std::string body;
};

class ViewApi {
 public:
  // `out`: folder for /api/save; empty: none. `force` as in RunOutput. `session` must outlive this object.
  ViewApi(ViewSession& session, std::filesystem::path out, bool force = false);

  // Thread-safe; never throws.
  ViewAnswer Answer(std::string_view method, std::string_view path, std::string_view body);

 private:
  ViewAnswer Dispatch(std::string_view method, std::string_view path, std::string_view body);
  ViewAnswer Session() const;
  ViewAnswer MeshOfScene() const;
  ViewAnswer Render(std::string_view body);
  ViewAnswer Recorded(std::string_view body) const;
  ViewAnswer Compare(std::string_view body);
  ViewAnswer Files(std::string_view body) const;
  ViewAnswer Save(std::string_view body);
  ViewAnswer StartFit(std::string_view body);

  ViewSession& session_;
  std::filesystem::path out_;
  bool force_;
  std::mutex save_mutex_;
  ViewFit fit_;
};

}  // namespace sonarcal::view
