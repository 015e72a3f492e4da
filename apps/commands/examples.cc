#include "apps/commands/examples.h"

#include <fmt/format.h>

#include <algorithm>

#include <CLI/CLI.hpp>

namespace sonarcal::commands {
namespace {

constexpr std::size_t kLineWidth = 98;

const std::string kScenes = "sonarcal scenes --only tank --out paper";
const std::string kRecord =
    "sonarcal simulate --scene paper/tank.gltf --sonar p900-45 --params paper/params.json "
    "--poses paper/poses_tank.json --rays 300x200 --noise --seed 1 --out recorded";
const std::string kSimulate =
    "sonarcal simulate --expected --scene paper/tank.gltf --sonar recorded --params paper/params.json "
    "--poses recorded --rays 300x200 --out simulated";
const std::string kCompare = "sonarcal compare --real recorded --sim simulated --out compared";
const std::string kFit =
    "sonarcal fit --real recorded --scene paper/tank.gltf --params paper/params.json --rays 300x200 "
    "--starts 1 --max-iterations 10 --out fitted";
const std::string kReproduce = "sonarcal reproduce --quick --out report";

// Breaks a line before options, as a shell joins it again.
std::string Wrapped(const std::string& line) {
  std::string text = "  ";
  std::size_t column = text.size();
  for (std::size_t start = 0; start < line.size();) {
    const std::size_t end = std::min(line.find(" --", start + 1), line.size());
    const std::string part = line.substr(start, end - start);
    if (column + part.size() > kLineWidth) {
      text += " \\\n     ";
      column = 5;
    }
    text += part;
    column += part.size();
    start = end;
  }
  return text + '\n';
}

std::string Text(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += Wrapped(line);
  return text;
}

}  // namespace

const std::vector<Example>& Examples() {
  static const std::vector<Example> kExamples = {
      {"scenes", {kScenes}},
      {"simulate", {kScenes, kRecord}},
      {"inspect", {kScenes, kRecord, "sonarcal inspect recorded"}},
      {"compare", {kScenes, kRecord, kSimulate, kCompare}},
      {"fit", {kScenes, kRecord, kFit}},
      {"sonars", {"sonarcal sonars"}},
      {"materials", {"sonarcal materials --list", "sonarcal materials sand:medium"}},
      {"recordings", {"sonarcal recordings"}},
      {"convert", {kScenes, kRecord, "sonarcal convert recorded --frames 0:2 --out first_two"}},
      {"export",
       {kScenes, kRecord, "sonarcal export --to png --recording recorded --height 300 --out pictures"}},
      {"rays",
       {kScenes,
        "sonarcal rays --scene paper/tank.gltf --sonar p900-45 --params paper/params.json "
        "--poses paper/poses_tank.json --rays 100x100 --rays 300x200 --dense 600x400 --denser 2"}},
      {"gallery", {"sonarcal gallery --only tank --rays 300x200 --out gallery"}},
      {"view",
       {kScenes, "sonarcal view --scene paper/tank.gltf --poses paper/poses_tank.json --sonar p900-45"},
       Needs::kTime},
      {"reproduce", {kReproduce}, Needs::kTime},
      {"calibrate",
       {kReproduce,
        "sonarcal calibrate --real report/synthetic_recording "
        "--scene report/synthetic_recording/scene.gltf --out calibrated"},
       Needs::kTime},
      {"explain",
       {kReproduce,
        "sonarcal explain --real report/synthetic_recording "
        "--scene report/synthetic_recording/scene.gltf "
        "--params report/tank_acoustic_initial_params.json --held-out 1,3 --rays 512x300 --out explained"},
       Needs::kTime},
      {"locate",
       {"sonarcal locate --real recording --frame 0 --target target.gltf --out located"},
       Needs::kFiles},
      {"poses",
       {"sonarcal poses --images pictures --camera camera.yaml --markers markers.json --mount mount.json "
        "--out poses"},
       Needs::kFiles},
      {"judge-noise",
       {"sonarcal fit --noise-only --real pings --out noise",
        "sonarcal judge-noise --params noise/params.json --real other_pings"},
       Needs::kFiles},
      {"transfer",
       {"sonarcal transfer --train simulated --object mockup --test recorded --test-masks masks"},
       Needs::kFiles},
      {"batch", {"sonarcal batch plan.json --out many --jobs 2"}, Needs::kFiles},
  };
  return kExamples;
}

void AddExamples(CLI::App& app) {
  for (const Example& example : Examples()) {
    CLI::App* command = app.get_subcommand(example.command);
    const bool own = example.needs == Needs::kFiles;
    command->footer(
        fmt::format("Example{}:\n{}", own ? ", with files of your own" : "", Text(example.lines)));
  }
  app.footer(
      fmt::format("Examples, one after the other:\n{}\n"
                  "'sonarcal help COMMAND' or 'sonarcal COMMAND --help' lists the options of a command.",
                  Text({kScenes, kRecord, kSimulate, kCompare})));
}

}  // namespace sonarcal::commands
