#include "calib/models/ping_echoes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

using sim::PixelEchoes;

// Position of the ping that receives each beam.
std::vector<std::size_t> PingOfBeam(const std::vector<PingPose>& pings, int beams) {
  std::vector<std::size_t> ping_of_beam(beams, pings.size());
  for (std::size_t ping = 0; ping < pings.size(); ++ping) {
    for (const int beam : pings[ping].beams) ping_of_beam.at(beam) = ping;
  }
  SONARCAL_CHECK(std::ranges::count(ping_of_beam, pings.size()) == 0, "a beam of {} has no ping", beams);
  return ping_of_beam;
}

// Takes each pixel from the image of its ping. An image without echoes has no pixels.
PixelEchoes Joined(const std::vector<PixelEchoes>& images, const std::vector<std::size_t>& ping_of_beam,
                   int materials) {
  std::size_t pixels = 0;
  for (const PixelEchoes& image : images)
    pixels = std::max(pixels, image.start.empty() ? 0 : image.start.size() - 1);
  PixelEchoes joined{.materials = materials, .start = {}, .entries = {}};
  if (pixels == 0) return joined;
  joined.start.reserve(pixels + 1);
  joined.start.push_back(0);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const PixelEchoes& image = images[ping_of_beam[pixel % ping_of_beam.size()]];
    if (!image.start.empty()) {
      joined.entries.insert(joined.entries.end(), image.entries.begin() + image.start[pixel],
                            image.entries.begin() + image.start[pixel + 1]);
    }
    joined.start.push_back(static_cast<std::uint32_t>(joined.entries.size()));
  }
  return joined;
}

// Paths of all pings, sorted.
std::vector<sim::GhostWay> AllWays(const std::vector<FrameEchoes>& of_pings) {
  std::vector<sim::GhostWay> ways;
  for (const FrameEchoes& echoes : of_pings)
    ways.insert(ways.end(), echoes.ghosts.ways.begin(), echoes.ghosts.ways.end());
  std::ranges::sort(ways);
  ways.erase(std::unique(ways.begin(), ways.end()), ways.end());
  return ways;
}

// Ghosts with the paths numbered as in `ways`, which is sorted and contains `own`, sorted too.
PixelEchoes Renumbered(PixelEchoes ghosts, const std::vector<sim::GhostWay>& own,
                       const std::vector<sim::GhostWay>& ways, int materials) {
  const auto nodes_of_way =
      static_cast<std::uint32_t>(sim::CoarseIncidenceDeg().size() * sim::kCurveParts * materials);
  std::vector<std::uint32_t> number;
  for (const sim::GhostWay& way : own)
    number.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(ways, way) - ways.begin()));
  for (PixelEchoes::Entry& entry : ghosts.entries)
    entry.node = number[entry.node / nodes_of_way] * nodes_of_way + entry.node % nodes_of_way;
  return ghosts;
}

}  // namespace

FrameEchoes EchoesByPing(const std::vector<PingPose>& pings, int beams,
                         const std::vector<FrameEchoes>& of_pings) {
  SONARCAL_CHECK(of_pings.size() == pings.size() && !pings.empty(), "echoes of {} pings, expected {}",
                 of_pings.size(), pings.size());
  const std::vector<std::size_t> ping_of_beam = PingOfBeam(pings, beams);
  const auto join = [&](int materials, const auto& image_of) {
    std::vector<PixelEchoes> images;
    std::ranges::transform(of_pings, std::back_inserter(images), image_of);
    return Joined(images, ping_of_beam, materials);
  };
  FrameEchoes frame{.at_point = join(of_pings.front().at_point.materials,
                                     [](const FrameEchoes& echoes) { return echoes.at_point; })};
  frame.ghosts.ways = AllWays(of_pings);
  for (const FrameEchoes& echoes : of_pings)
    frame.ghosts.materials = std::max(frame.ghosts.materials, echoes.ghosts.materials);
  const int materials = frame.ghosts.materials;
  const int paths = static_cast<int>(frame.ghosts.ways.size()) * materials * sim::kCurveParts;
  frame.ghosts.pixels = join(paths, [&](const FrameEchoes& echoes) {
    return Renumbered(echoes.ghosts.pixels, echoes.ghosts.ways, frame.ghosts.ways, materials);
  });
  for (std::size_t i = 0; i < of_pings.front().slopes.size(); ++i) {
    EchoSlope slope{.entry = of_pings.front().slopes[i].entry};
    slope.echoes = join(of_pings.front().slopes[i].echoes.materials,
                        [&](const FrameEchoes& echoes) { return echoes.slopes[i].echoes; });
    slope.ghosts = join(paths, [&](const FrameEchoes& echoes) {
      return Renumbered(echoes.slopes[i].ghosts, echoes.ghosts.ways, frame.ghosts.ways, materials);
    });
    frame.slopes.push_back(std::move(slope));
  }
  return frame;
}

}  // namespace sonarcal::calib
