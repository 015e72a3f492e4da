#include "apps/cli/bag_options.h"

#include <CLI/CLI.hpp>

#include "apps/cli/choice_option.h"
#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "data_io/pictures/picture_io.h"

namespace sonarcal::cli {
namespace {}  // namespace

void AddBagOptions(CLI::App& command, BagArguments& arguments) {
  data_io::BagOptions& options = arguments.bag;
  command.add_option("--topic", options.topic, "The sonar's topic in a ROS bag (default: the only one)")
      ->type_name("NAME");
  AddChoice(command, "--sample-order", options.message.sample_order,
            "Order of the samples of a ProjectedSonarImage: beam by beam or range by range");
  command.add_flag("--mirror", options.message.mirrored, "Exchange left and right of a ROS bag's images");
  command
      .add_option("--picture-geometry", arguments.picture_geometry,
                  "Geometry of the pixels of pictures, of a video, or of plain pictures in a ROS bag "
                  "(sonar-picture-geometry/1; default: the file beside them)")
      ->type_name("FILE");
}

std::unique_ptr<RecordingSource> OpenWithBagOptions(const std::filesystem::path& named,
                                                    const BagArguments& arguments) {
  if (arguments == BagArguments{}) return data_io::OpenRecording(named);
  BagArguments picture_only;
  picture_only.picture_geometry = arguments.picture_geometry;
  const bool for_pictures = arguments == picture_only;
  // A folder of pictures stands for itself, whatever else it holds.
  const std::filesystem::path path =
      for_pictures && data_io::IsPictures(named) ? named : data_io::LocateRecording(named);
  if (for_pictures && data_io::IsPictures(path))
    return data_io::OpenPictureRecording(path, data_io::ReadPictureGeometry(arguments.picture_geometry));
  std::error_code error;
  if (std::filesystem::exists(path, error) && !data_io::IsBag(path)) {
    throw UsageError(
        "--topic, --sample-order and --mirror are for ROS bags, "
        "--picture-geometry for them and for pictures, expected one in place of {}",
        path.string());
  }
  data_io::BagOptions options = arguments.bag;
  if (!arguments.picture_geometry.empty())
    options.message.geometry = data_io::ReadPictureGeometry(arguments.picture_geometry);
  return data_io::OpenBagRecording(path, options);
}

}  // namespace sonarcal::cli
