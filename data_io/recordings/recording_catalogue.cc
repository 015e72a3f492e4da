#include "data_io/recordings/recording_catalogue.h"

#include <cstdlib>

#include "data_io/files/hash.h"

namespace sonarcal::data_io {

namespace fs = std::filesystem;

const std::vector<PublicRecording>& RecordingCatalogue() {
  static const std::vector<PublicRecording> catalogue = {
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
                "settings; no poses",
       .licence = "GPL-3.0",
       .source = "https://github.com/pvazteixeira/multibeam",
       .commit = "4c341cae7a6a856d4227001ac0309e1d6421a048",
       .paths = {{"data/background", "background"}, {"data/test", "test"}, {"LICENSE", "LICENSE"}},
       .witness = "background/1468966397006010.png",
       .witness_sha256 = "cfad09d48fc92bfb1390619f736609a1fae18e7a21d52503586fdf09e252b2d1"},
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
      {.name = "uxo_dataset2024",
       .sensor = "Sound Metrics ARIS Explorer 3000, 3 MHz, on a gantry",
       .shows =
           "dummies of ammunition in a test basin: 74,000 raw frames with the poses of sonar and targets, "
           "and models of them",
       .licence = "see its page",
       .source = "https://zenodo.org/records/11068046",
       .commit = {},
       .paths = {},
       .witness = {},
       .witness_sha256 = {}},
  };
  return catalogue;
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
