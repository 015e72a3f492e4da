// What the page of `sonarcal view` may ask, each an answer from a request, without a socket:
//
//   GET  /api/session       what is shown: names, axes, controls, poses, colours; JSON
//   GET  /api/scene         the mesh; framed
//   POST /api/render        STATE -> the simulated image; framed, or 204 where a newer request of the same
//                           client came meanwhile
//   POST /api/recorded      {"frame"} -> a recorded frame; framed
//   POST /api/compare       STATE -> figures of metrics.json's frames, and the object regions; framed
//   POST /api/files         STATE -> {"files": {"params.json": text, ...}, "command"}; JSON
//   POST /api/save          STATE -> the same, written into --out; JSON
//   POST /api/fit/start     {"state": STATE, "hold": [names], "starts", "max_iterations"} -> status; JSON
//   POST /api/fit/stop      {} -> status; JSON
//   GET  /api/fit           status (apps/view/view_fit.h); JSON
//
// STATE is that of apps/view/view_state.h. A framed answer is a little-endian number of four bytes, as many
// bytes of JSON, and the data it describes: an image as grey values, range bins x beams, nearest first, of
// one or two (little-endian) bytes each; the mesh as {vertices x 3 floats, triangles x 3 numbers of four
// bytes, materials of two bytes}, each from a multiple of four bytes on. A request that can't be met gets
// {"error": sentence} with status 400 where it is no such request, 404 where nothing is there, and 422 where
// what it asks for cannot be made.
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
  // `out`: the folder that /api/save writes; empty for none; `force` as of RunOutput. `session` must outlive
  // this.
  ViewApi(ViewSession& session, std::filesystem::path out, bool force = false);

  // Any thread; never throws.
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
