#include "tests/metrics/human_masks.h"

#include <algorithm>
#include <cmath>
#include <regex>

#include "core/types/units.h"
#include "data_io/files/file_bytes.h"
#include "data_io/images/image_io.h"
#include "data_io/pictures/picture_frames.h"
#include "data_io/pictures/picture_geometry.h"

namespace sonarcal::testing {
namespace {

constexpr double kHalfAngleDeg = 15.126;  // of an ARIS 3000, as are its beams
constexpr int kMaskBeams = 128;
constexpr double kPixelsPerBin = 2.0;
constexpr int kBoxMarginPx = 10;
constexpr int kLastObject = 10;
constexpr std::size_t kMaxBytes = 1 << 20;  // of a file of boxes

struct Box {
  int left = 0, top = 0, right = 0, bottom = 0;  // all within

  bool Contains(int row, int col, int margin) const {
    return col >= left - margin && col <= right + margin && row >= top - margin && row <= bottom + margin;
  }
};

// Boxes of all that is no wall.
std::vector<Box> AnnotatedBoxes(const std::filesystem::path& file) {
  const std::string text = data_io::ReadFileBytes(file, kMaxBytes);
  static const std::regex kObject(
      R"(<name>([^<]*)</name>\s*<bndbox>\s*<x>(\d+)</x>\s*<y>(\d+)</y>\s*<w>(\d+)</w>\s*<h>(\d+)</h>)");
  std::vector<Box> boxes;
  for (std::sregex_iterator it(text.begin(), text.end(), kObject), end; it != end; ++it) {
    if ((*it)[1] == "Wall") continue;
    const auto number = [&](int group) { return std::stoi((*it)[group]); };
    boxes.push_back({number(2), number(3), number(2) + number(4) - 1, number(3) + number(5) - 1});
  }
  return boxes;
}

bool IsObject(float value) {
  return value >= 1.0F && value <= kLastObject;
}

// Where an object's box is called a wall's, its pixels lie in no box of an object: the mask's own box.
void AddBoxesOfTheRest(const Grid<float>& classes, std::vector<Box>& boxes) {
  for (int label = 1; label <= kLastObject; ++label) {
    Box own{classes.cols(), classes.rows(), -1, -1};
    bool outside = false;
    for (int row = 0; row < classes.rows(); ++row) {
      for (int col = 0; col < classes.cols(); ++col) {
        if (classes(row, col) != static_cast<float>(label)) continue;
        own = {std::min(own.left, col), std::min(own.top, row), std::max(own.right, col),
               std::max(own.bottom, row)};
        outside = outside || std::none_of(boxes.begin(), boxes.end(), [&](const Box& box) {
                    return box.Contains(row, col, kBoxMarginPx);
                  });
      }
    }
    if (outside) boxes.push_back(own);
  }
}

data_io::PictureGeometry GeometryOf(const Grid<float>& picture, const std::string& name) {
  Mask lit(picture.rows(), picture.cols());
  for (std::size_t i = 0; i < lit.size(); ++i) lit.values()[i] = picture.values()[i] > 0.0F ? 1 : 0;
  const std::optional<data_io::FanGeometry> fan = data_io::FindFanGeometry(lit);
  if (!fan) throw DataError("{}: no fan was made out in the picture", name);
  data_io::PictureGeometry geometry;
  geometry.half_angle_deg = kHalfAngleDeg;
  geometry.TakeFound(*fan);
  geometry.beams = kMaskBeams;
  geometry.range_bins = static_cast<int>(
      std::lround((geometry.fan->radius_max_px - geometry.fan->radius_min_px) / kPixelsPerBin));
  geometry.range_min_m = geometry.fan->radius_min_px / 100.0;
  geometry.range_max_m = geometry.fan->radius_max_px / 100.0;
  return geometry;
}

HumanMask ReadOne(const std::filesystem::path& image_file, const std::filesystem::path& folder) {
  HumanMask read;
  read.name = image_file.stem().string();
  read.number = std::stoi(read.name.substr(read.name.rfind('-') + 1));
  const Grid<float> picture = data_io::OpenPictures(image_file)->Read(0);
  const Grid<float> classes = data_io::ImageFile(folder / "Masks" / image_file.filename()).DecodeGrey();
  if (classes.rows() != picture.rows() || classes.cols() != picture.cols()) {
    throw DataError("{}: a mask of {} x {} pixels, expected {} x {}", read.name, classes.rows(),
                    classes.cols(), picture.rows(), picture.cols());
  }
  std::vector<Box> boxes = AnnotatedBoxes(folder / "BoxAnnotations" / (read.name + ".xml"));
  AddBoxesOfTheRest(classes, boxes);
  const auto in_box = [&](int row, int col) {
    return std::any_of(boxes.begin(), boxes.end(),
                       [&](const Box& box) { return box.Contains(row, col, kBoxMarginPx); });
  };

  const data_io::PictureGeometry geometry = GeometryOf(picture, read.name);
  const data_io::PictureSampler sampler(geometry, picture.rows(), picture.cols(), read.name);
  const PolarAxes& axes = sampler.axes();
  read.image = {axes, {}, sampler.Apply(picture)};
  const data_io::FanGeometry& fan = *geometry.fan;
  const double half_rad = RadFromDeg(fan.half_angle_deg);
  Grid<float> box_picture(picture.rows(), picture.cols());
  for (int row = 0; row < picture.rows(); ++row) {
    for (int col = 0; col < picture.cols(); ++col) {
      if (in_box(row, col)) box_picture(row, col) = 1.0F;
      const double across = (col - fan.apex_x_px) / fan.x_scale;
      const double ahead = fan.apex_y_px - row;
      const double bin = (std::hypot(across, ahead) - fan.radius_min_px) / (100.0 * axes.range_bin_m());
      const double beam = (std::atan2(across, ahead) / half_rad + 1.0) / 2.0 * axes.beam_count();
      if (!(bin >= 0.0 && bin < axes.range_bins && beam >= 0.0 && beam < axes.beam_count())) continue;
      read.polar_index.push_back(static_cast<int>(bin) * axes.beam_count() + static_cast<int>(beam));
      read.object.push_back(IsObject(classes(row, col)) ? 1 : 0);
      read.in_box.push_back(in_box(row, col) ? 1 : 0);
    }
  }
  const Grid<float> box = sampler.Apply(box_picture);
  read.box = Mask(box.rows(), box.cols());
  for (std::size_t i = 0; i < box.size(); ++i) read.box.values()[i] = box.values()[i] >= 0.5F ? 1 : 0;
  return read;
}

}  // namespace

std::vector<HumanMask> ReadHumanMasks(const std::filesystem::path& folder) {
  std::vector<HumanMask> pictures;
  for (const auto& file : data_io::PicturesOf(folder / "Images")) pictures.push_back(ReadOne(file, folder));
  return pictures;
}

Agreement Agree(const HumanMask& picture, const Mask& found, bool in_box) {
  double both = 0.0, ours = 0.0, theirs = 0.0;
  for (std::size_t i = 0; i < picture.polar_index.size(); ++i) {
    if (in_box && picture.in_box[i] == 0) continue;
    const bool is_found = found.values()[picture.polar_index[i]] != 0;
    const bool is_object = picture.object[i] != 0;
    both += is_found && is_object;
    ours += is_found;
    theirs += is_object;
  }
  const auto share = [](double part, double of) { return of > 0.0 ? part / of : 0.0; };
  return {share(both, ours + theirs - both), share(both, ours), share(both, theirs)};
}

}  // namespace sonarcal::testing
