// Real recordings that can be explained (apps/commands/explain_command.h) although they came without scene, pose or
// parameters, and what the project knows or assumes in place of these. Recordings lie in the user's folder
// and never in the project; what is made of them here is as another command wants it, and is written where
// the user says.
//
//   bomb        two frames of a bomb, recorded by an ARIS 3000 (aris3000_uxo), and the other pose of it:
//               frame 0 is fitted; 1 shows the same still scene, so that receiver noise alone is new in it;
//               2, the other pose, is independent. Outline and poses are those of calib/bomb_fit.h,
//               beam, pulse and curve are fitted to frame 0, and the pose of frame 2 to frame 2 with all else
//               held.
//   hull-strip  three pings of a ship's hull, recorded by a DIDSON (didson_hull), in which a person marked
//   the
//               first return: 0 and 1 are fitted, 2 is held out. The scene is a strip of surface through the
//               marks of each ping (apps/reproduce/hull_strip.h), the noise that of the recording's
//               target-free pings. How far the strips lean is chosen by the likelihood of 0 and 1.
//
// To add one: a value and a word here, a Prepare function, a line in PrepareKnown.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "apps/workflow/compare.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"
#include "core/types/words.h"

namespace sonarcal::reproduce {

enum class KnownRecording { kBomb, kHullStrip };
constexpr auto WordsOf(std::type_identity<KnownRecording>) {
  return Words<KnownRecording, 2>{
      {{"bomb", KnownRecording::kBomb}, {"hull-strip", KnownRecording::kHullStrip}}};
}

struct PreparedRecording {
  std::string title;                           // said wherever its pictures are shown
  std::unique_ptr<MemoryRecording> recording;  // a pose with every frame
  Scene scene;
  ParameterSet parameters;
  metrics::CompareOptions comparison = {};  // how its object is found
  std::vector<int> held_out;
  bool apart = false;       // held-out frames tell different things, so that they are judged one by one
  bool hold_noise = false;  // the floor of the parameters was found where there is nothing else
  std::vector<std::string> warnings = {};  // a search that ended at the end of its range, a sentence each
  // What a reader must know, a sentence each: what was assumed, and what a figure does not show.
  std::vector<std::string> caveats;
  std::vector<std::filesystem::path> inputs;
};

struct PrepareOptions {
  int threads = 0;
  bool quick = false;  // few rays: to try the way, not for figures
  std::function<void(const std::string& line)> on_note = {};
};

// `recordings` is the folder of all of them. Throws DataError where a recording is absent or damaged, or
// what has to be fitted ends without a usable solution.
PreparedRecording PrepareKnown(KnownRecording known, const std::filesystem::path& recordings,
                               const PrepareOptions& options = {});

PreparedRecording PrepareBombRecording(const std::filesystem::path& folder, const PrepareOptions& options);
PreparedRecording PrepareHullRecording(const std::filesystem::path& folder, const PrepareOptions& options);

// As a recording folder with its scene.gltf and params.json beside the frames, for every other command.
// `folder` must not be there.
void WritePrepared(const PreparedRecording& prepared, const std::filesystem::path& folder);

}  // namespace sonarcal::reproduce
