#include "data_io/recordings/recording_catalogue.h"

#include <cstdlib>

#include "data_io/files/hash.h"

namespace sonarcal::data_io {

namespace fs = std::filesystem;

namespace {

std::vector<PublicRecording::Path> ArisSdkPaths() {
  std::vector<PublicRecording::Path> paths = {
      {"LICENSE", "LICENSE"},
      {"sample-code/reorder-frame/input.dat", "reorder_frame_input.dat"},
      {"sample-code/reorder-frame/result.exp", "reorder_frame_result.dat"}};
  for (const char* mode : {"1_1200", "1_1800", "3", "9"}) {
    for (const char* what : {"input", "expected"}) {
      const std::string name = std::string(what) + "_pingmode_" + mode + ".dat";
      paths.push_back({"common/code/Reordering/UnitTests/data/" + name, name});
    }
  }
  return paths;
}

}  // namespace

const std::vector<PublicRecording>& RecordingCatalogue() {
  static const std::vector<PublicRecording> kCatalogue = {
      {.name = "aris1200_telephoto",
       .sensor = "Sound Metrics ARIS 1200, telephoto lens",
       .shows = "a river, 6 frames of 48 beams x 2000 samples; native file, no poses",
       .licence = "MIT",
       .source = "https://github.com/SoundMetrics/aris-file-sdk",
       .commit = "8c7bb21ee8e8b3062a0c6a8e80d4d56a9a9b92ca",
       .paths = {{"sample-code/sample.aris", "sample.aris"}, {"LICENSE", "LICENSE"}},
       .witness = "sample.aris",
       .witness_sha256 = "126e2cd99fc2428ce58b8f0fb535f46d94c8a7e2a1431157ca5fab0105ecb44f"},
      {.name = "oculus_m1200d",
       .sensor = "Blueprint Oculus (M1200d presumed), 2.1 MHz",
       .shows = "one native ping of 256 beams x 703 ranges, 8 bits; no pose",
       .licence = "BSD-3-Clause",
       .source = "https://github.com/apl-ocean-engineering/liboculus",
       .commit = "f33830622da92b5d7915ca7a7df703c7e1226749",
       .paths = {{"test/data/one_ping_8bit.raw", "one_ping_8bit.raw"}, {"LICENSE", "LICENSE"}},
       .witness = "one_ping_8bit.raw",
       .witness_sha256 = "04f896d0858fe7ca693ddd2b1ba0feca37d9be4fc2bdb40a70a2835082bf0e93"},
      {.name = "oculus_m1200d_three_pings",
       .sensor = "Blueprint Oculus (M1200d presumed), 2.1 MHz",
       .shows = "three native pings, one after the other, of the same sonar; no poses",
       .licence = "BSD-3-Clause",
       .source = "https://github.com/apl-ocean-engineering/liboculus",
       .commit = "f33830622da92b5d7915ca7a7df703c7e1226749",
       .paths = {{"test/data/three_pings_8bit.raw", "three_pings_8bit.raw"}, {"LICENSE", "LICENSE"}},
       .witness = "three_pings_8bit.raw",
       .witness_sha256 = "62053c1629e1c291434512517d80ac5596f16e48ce8840a12c1f93fe33ea45a6"},
      {.name = "didson_hull",
       .sensor = "Sound Metrics DIDSON, 96 beams x 512 ranges",
       .shows = "open water without a target (background/) and a ship's hull (test/): pictures with their "
                "settings, and marks of the hull by a person (first_return/); no poses",
       .licence = "GPL-3.0",
       .source = "https://github.com/pvazteixeira/multibeam",
       .commit = "4c341cae7a6a856d4227001ac0309e1d6421a048",
       .paths = {{"data/background", "background"},
                 {"data/test", "test"},
                 {"data/test/annotated", "first_return"},
                 {"LICENSE", "LICENSE"}},
       .witness = "background/1468966397006010.png",
       .witness_sha256 = "cfad09d48fc92bfb1390619f736609a1fae18e7a21d52503586fdf09e252b2d1"},
      {.name = "aris3000_uxo",
       .sensor = "Sound Metrics ARIS Explorer 3000, 3 MHz",
       .shows =
           "a bomb on a pedestal in a test basin: two frames of 128 beams x 780 ranges that were recovered "
           "from fan pictures of the source, and a fan picture of another pose; no poses",
       .licence = "none stated",
       .source = "https://github.com/dfki-ric/uxo-dataset2024",
       .commit = {},
       .paths = {},
       .witness = "frame_0000_128x780.png",
       .witness_sha256 = "faa69431c4d3cdd565dc51b5afb30cb2a71ed230f5187caebc4e798a5ae5a116"},
      {.name = "aris3000_watertank",
       .sensor = "Sound Metrics ARIS Explorer 3000, 3 MHz",
       .shows = "household objects in a water tank: resized fan pictures, with masks of each object; ranges "
                "and poses were not recorded",
       .licence = "none stated",
       .source = "https://github.com/DeepanChakravarthiPadmanabhan/marine-debris-fls-datasets",
       .commit = {},
       .paths = {},
       .witness = "Images/marine-debris-aris3k-0.png",
       .witness_sha256 = "bd48b6601147c37b1c06489fa1bfbf9c363f4d10e6720eaa27648bcdba55363b"},
      {.name = "aris_sdk_frames",
       .sensor = "Sound Metrics ARIS, 48, 96 and 128 beams",
       .shows = "a slab with its shadow: samples in the order of sending, and sorted by beam; no headers",
       .licence = "MIT",
       .source = "https://github.com/SoundMetrics/aris-integration-sdk",
       .commit = "61cffa6753f8c8abf19b094398dbbb167f1634df",
       .paths = ArisSdkPaths(),
       .witness = "input_pingmode_9.dat",
       .witness_sha256 = "aa46386acf2635f2ee6a839411aa0d59e3d341a4e01767236946d1bc323549f1"},
      {.name = "aris3000_broken",
       .sensor = "Sound Metrics ARIS 3000, 128 beams",
       .shows = "a broken recording, 27 frames: only one of eight pings has samples",
       .licence = "MIT",
       .source = "https://github.com/SoundMetrics/aris-integration-sdk",
       .commit = "d04053523855e5a82ff118caf3599f192edac105",
       .paths = {{"sample-code/vc-using-framestream/vc-using-framestream/output.aris", "output.aris"},
                 {"LICENSE", "LICENSE"}},
       .witness = "output.aris",
       .witness_sha256 = "e2781f4f253af146e883fe881597b23d897d73ec0acced665fff081fc19d133f"},
      {.name = "didson_videos",
       .sensor = "Sound Metrics DIDSON",
       .shows = "lampreys and a pike, fan videos of its viewer; ranges are printed in one of them",
       .licence = "Apache-2.0",
       .source = "https://github.com/safnuk/DIDSON.jl",
       .commit = "7ebbe8866152d4606651e2857c11f4d4638ea78c",
       .paths = {{"data/lamprey1.avi", "lamprey1.avi"},
                 {"data/lamprey2.avi", "lamprey2.avi"},
                 {"data/pike1.avi", "pike1.avi"},
                 {"LICENSE.md", "LICENSE.md"}},
       .witness = "pike1.avi",
       .witness_sha256 = "719e25cc556b34a14dd5489bc3a54947c2fa8c64a52527c95ffd660c148ef928"},
      {.name = "uxo_dataset2024",
       .sensor = "Sound Metrics ARIS Explorer 3000, 3 MHz, on a gantry",
       .shows = "ammunition and a cylinder in a test basin: 74,000 raw frames",
       .truth = "poses of sonar and targets; models of the targets",
       .licence = "see its page; BSD-3-Clause according to others",
       .source = "https://github.com/dfki-ric/uxo-dataset2024",
       .data = "https://zenodo.org/records/13778485",
       .commit = {},
       .paths = {},
       .witness = {},
       .witness_sha256 = {}},
      {.name = "opti_acoustic_2025",
       .sensor = "Blueprint Oculus M750d, with a camera",
       .shows = "piers and sea walls in a tank and in a marina: ROS 1 bags (sonar_oculus/OculusPing) and ROS "
                "2 bags",
       .truth = "odometry; STL models of the structures in the tank",
       .licence = "MIT (code); of the data none stated, a citation is asked for",
       .source = "https://github.com/ivanacollg/sonar_camera_reconstruction",
       .data = "https://drive.google.com/drive/folders/1P7bbY_ikMIOyv38ZTB3Xp3M5JepqIdYG",
       .commit = {},
       .paths = {},
       .witness = {},
       .witness_sha256 = {}},
      {.name = "sonarsplat",
       .sensor = "imaging sonar of a robot (see its paper)",
       .shows = "a test tank, empty and with structures, and a shipwreck in a lake: one pickle per frame",
       .truth = "pose of each frame; point clouds of the 3-D scenes",
       .licence = "CC BY-NC-SA 4.0 (stated for the project)",
       .source = "https://umfieldrobotics.github.io/sonarsplat3D/",
       .data = "https://drive.google.com/file/d/1sDGprDT-kS-Eunt5XjXAFMkMe1t3GIbd",
       .commit = {},
       .paths = {},
       .witness = {},
       .witness_sha256 = {}},
      {.name = "neusis",
       .sensor = "imaging sonar with 14 and 28 degrees of elevation (see its paper)",
       .shows = "SYNTHETIC objects, and according to its configurations a real one: one pickle per view",
       .truth = "pose of each view",
       .licence = "MIT (code); of the data none stated",
       .source = "https://github.com/rpl-cmu/neusis",
       .data = "https://drive.google.com/drive/folders/161PNPuIfsIwAsRjOc2PXQUkjO4F0P5Nr",
       .commit = {},
       .paths = {},
       .witness = {},
       .witness_sha256 = {}},
  };
  return kCatalogue;
}

RecordingPresence PresenceOf(const PublicRecording& recording, const fs::path& recordings) {
  const fs::path folder = recordings / recording.name;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return RecordingPresence::kAbsent;
  if (recording.witness.empty()) return RecordingPresence::kPresent;
  const fs::path witness = folder / recording.witness;
  if (!fs::is_regular_file(witness, error)) return RecordingPresence::kDifferent;
  return Sha256OfFile(witness) == recording.witness_sha256 ? RecordingPresence::kPresent
                                                           : RecordingPresence::kDifferent;
}

fs::path DefaultRecordingsFolder() {
  const char* folder = std::getenv("SONARCAL_RECORDINGS");
  return folder != nullptr && *folder != '\0' ? fs::path(folder) : fs::path("recordings");
}

}  // namespace sonarcal::data_io
