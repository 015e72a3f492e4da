// What other simulators' documentation and sources say that they read, written down from those pages and not
// from our exports. XML by path from the sensor on, attributes with an '@'; JSON by path.
#pragma once

#include <set>
#include <string>

namespace sonarcal::testing {

struct Schema {
  std::set<std::string> known;     // all that may stand there
  std::set<std::string> required;  // what must
};

// github.com/Field-Robotics-Lab/nps_uw_multibeam_sonar at 47dae1f. Of the plugin: every HasElement of
// src/gazebo_multibeam_sonar_raster_based.cpp. Of the sensor: SDF 1.6 (github.com/gazebosim/sdformat at
// 2ace536, sdf/1.6/sensor.sdf and camera.sdf), as used in models/*_nps_multibeam/model.sdf.
inline Schema DaveSchema() {
  Schema schema;
  schema.known = {"@name",
                  "@type",
                  "always_on",
                  "update_rate",
                  "visualize",
                  "pose",
                  "topic",
                  "camera",
                  "camera/@name",
                  "camera/horizontal_fov",
                  "camera/image",
                  "camera/image/width",
                  "camera/image/height",
                  "camera/image/format",
                  "camera/clip",
                  "camera/clip/near",
                  "camera/clip/far",
                  "camera/depth_camera",
                  "camera/depth_camera/output",
                  "camera/save",
                  "camera/noise",
                  "plugin",
                  "plugin/@name",
                  "plugin/@filename"};
  for (const char* element : {"imageTopicName",
                              "cameraInfoTopicName",
                              "depthImageTopicName",
                              "depthImageCameraInfoTopicName",
                              "pointCloudTopicName",
                              "pointCloudCutoff",
                              "sonarImageRawTopicName",
                              "sonarImageTopicName",
                              "verticalFOV",
                              "sonarFreq",
                              "bandwidth",
                              "soundSpeed",
                              "maxDistance",
                              "sourceLevel",
                              "constantReflectivity",
                              "artificialVehicleVibration",
                              "customSDFTagReflectivity",
                              "raySkips",
                              "plotScaler",
                              "sensorGain",
                              "reflectivityDatabaseFile",
                              "customSDFTagDatabaseFile",
                              "fiducial",
                              "writeLog",
                              "writeFrameInterval",
                              "debugFlag",
                              "cameraName",
                              "frameName"}) {
    schema.known.insert(std::string("plugin/") + element);
  }
  schema.required = {"@name",
                     "@type",
                     "camera/horizontal_fov",
                     "camera/image/width",
                     "camera/image/height",
                     "camera/clip/near",
                     "camera/clip/far",
                     "plugin/@name",
                     "plugin/@filename",
                     "plugin/raySkips"};  // its default of 10 leaves out nine rows of ten
  return schema;
}

// client/src/holoocean/sensors.py of HoloOcean, the docstring of ImagingSonar: all options of its
// "configuration"; byu-holoocean.github.io/holoocean-docs/v2.3.0, sensors/docs/sensor-config: those beside
// it.
inline Schema HoloOceanSchema() {
  Schema schema;
  schema.known = {"sensor_type", "sensor_name", "socket",      "location",     "rotation",
                  "Hz",          "lcm_channel", "ros_publish", "configuration"};
  for (const char* option :
       {"Azimuth",       "Elevation",       "RangeMin",   "RangeMax",        "RangeBins",  "RangeRes",
        "AzimuthBins",   "AzimuthRes",      "AddSigma",   "AddCov",          "MultSigma",  "MultCov",
        "MultiPath",     "ClusterSize",     "ScaleNoise", "AzimuthStreaks",  "RangeSigma", "ShowWarning",
        "ElevationBins", "ElevationRes",    "ViewRegion", "InitOctreeRange", "ViewOctree", "ShadowEpsilon",
        "WaterDensity",  "WaterSpeedSound", "UseApprox"}) {
    schema.known.insert(std::string("configuration/") + option);
  }
  schema.required = {"sensor_type"};
  return schema;
}

// github.com/IOES-Lab/dave at d655441,
// gazebo/dave_gz_multibeam_sonar/multibeam_sonar/MultibeamSonarSensor.cc: every Get and GetElement, and the
// attributes that it requires.
inline Schema DaveRos2Schema() {
  Schema schema;
  schema.known = {"@name",
                  "@type",
                  "@gz:type",
                  "always_on",
                  "update_rate",
                  "visualize",
                  "topic",
                  "gz:multibeam_sonar",
                  "gz:multibeam_sonar/reference_frame",
                  "gz:multibeam_sonar/ray",
                  "gz:multibeam_sonar/ray/@degrees",
                  "gz:multibeam_sonar/ray/scan",
                  "gz:multibeam_sonar/ray/range",
                  "gz:multibeam_sonar/ray/range/min",
                  "gz:multibeam_sonar/ray/range/max",
                  "gz:multibeam_sonar/spec"};
  for (const char* axis : {"horizontal", "vertical"}) {
    const std::string path = std::string("gz:multibeam_sonar/ray/scan/") + axis;
    schema.known.insert({path, path + "/min_angle", path + "/max_angle"});
  }
  schema.known.insert(
      {"gz:multibeam_sonar/ray/scan/horizontal/beams", "gz:multibeam_sonar/ray/scan/vertical/rays"});
  for (const char* element :
       {"verticalFOV", "sonarFreq", "bandwidth", "soundSpeed", "maxDistance", "sourceLevel", "raySkips",
        "plotScaler", "sensorGain", "debugFlag", "blazingSonarImage", "pointCloudTopicName",
        "sonarImageRawTopicName", "sonarImageTopicName", "frameName", "writeLog", "writeFrameInterval"}) {
    schema.known.insert(std::string("gz:multibeam_sonar/spec/") + element);
  }
  schema.required = {"@name",
                     "@type",
                     "@gz:type",
                     "gz:multibeam_sonar/ray/scan/horizontal/beams",
                     "gz:multibeam_sonar/ray/scan/vertical/rays",
                     "gz:multibeam_sonar/ray/range/min",
                     "gz:multibeam_sonar/ray/range/max",
                     "gz:multibeam_sonar/spec/raySkips"};
  return schema;
}

// github.com/patrykcieslak/stonefish at b21eb8e: Library/src/core/ScenarioParser.cpp, the branch of "fls",
// and docs/sensors.rst. A sensor at the root of a scenario has world_transform, one of a robot origin and
// link.
inline Schema StonefishSchema() {
  return {.known = {"@name",
                    "@type",
                    "@rate",
                    "specs",
                    "specs/@beams",
                    "specs/@bins",
                    "specs/@horizontal_fov",
                    "specs/@vertical_fov",
                    "specs/@output_format",
                    "settings",
                    "settings/@range_min",
                    "settings/@range_max",
                    "settings/@gain",
                    "noise",
                    "noise/@multiplicative",
                    "noise/@additive",
                    "display",
                    "display/@colormap",
                    "world_transform",
                    "world_transform/@xyz",
                    "world_transform/@rpy",
                    "origin",
                    "origin/@xyz",
                    "origin/@rpy",
                    "link",
                    "link/@name"},
          .required = {"@name", "@type", "specs/@beams", "specs/@bins", "specs/@horizontal_fov",
                       "specs/@vertical_fov", "world_transform/@xyz", "world_transform/@rpy"}};
}

// The rest of such a scenario: Parse, ParseEnvironment, ParseMaterials, ParseLooks, and ParseStatic for the
// type "model". Required: elements and attributes without which these functions fail.
inline Schema StonefishScenarioSchema() {
  return {.known = {"environment",
                    "environment/ned",
                    "environment/ned/@latitude",
                    "environment/ned/@longitude",
                    "materials",
                    "materials/material",
                    "materials/material/@name",
                    "materials/material/@density",
                    "materials/material/@restitution",
                    "materials/material/@magnetic",
                    "looks",
                    "looks/look",
                    "looks/look/@name",
                    "looks/look/@gray",
                    "looks/look/@rgb",
                    "looks/look/@roughness",
                    "looks/look/@metalness",
                    "looks/look/@reflectivity",
                    "static",
                    "static/@name",
                    "static/@type",
                    "static/physical",
                    "static/physical/mesh",
                    "static/physical/mesh/@filename",
                    "static/physical/mesh/@scale",
                    "static/physical/mesh/@convex",
                    "static/physical/origin",
                    "static/physical/origin/@xyz",
                    "static/physical/origin/@rpy",
                    "static/material",
                    "static/material/@name",
                    "static/look",
                    "static/look/@name",
                    "static/world_transform",
                    "static/world_transform/@xyz",
                    "static/world_transform/@rpy",
                    "sensor"},
          .required = {"environment/ned/@latitude", "environment/ned/@longitude", "materials/material/@name",
                       "materials/material/@density", "materials/material/@restitution", "looks/look/@name",
                       "looks/look/@gray", "looks/look/@roughness", "static/@name", "static/@type",
                       "static/physical/mesh/@filename", "static/physical/origin/@xyz",
                       "static/physical/origin/@rpy", "static/material/@name", "static/look/@name",
                       "static/world_transform/@xyz", "static/world_transform/@rpy", "sensor"}};
}

// github.com/umfieldrobotics/OceanSim at 2809388, isaacsim/oceansim/sensors/ImagingSonarSensor.py: arguments
// of __init__, sonar_initialize and make_sonar_data; reflectivity is the type of a semantic label
// (docs/subsections/running_example.md), its members are materials.
inline Schema OceanSimSchema() {
  Schema schema;
  schema.known = {"ImagingSonarSensor", "sonar_initialize", "make_sonar_data", "reflectivity"};
  for (const char* argument : {"prim_path", "name", "frequency", "dt", "position", "orientation",
                               "translation", "render_product_path", "physics_sim_view", "min_range",
                               "max_range", "range_res", "hori_fov", "vert_fov", "angular_res", "hori_res"}) {
    schema.known.insert(std::string("ImagingSonarSensor/") + argument);
  }
  for (const char* argument :
       {"normalizing_method", "viewport", "privileged_bbox", "include_unlabelled", "if_array_copy"}) {
    schema.known.insert(std::string("sonar_initialize/") + argument);
  }
  for (const char* argument : {"query_prop", "attenuation", "gau_noise_param", "ray_noise_param",
                               "intensity_offset", "intensity_gain", "central_peak", "central_std"}) {
    schema.known.insert(std::string("make_sonar_data/") + argument);
  }
  schema.required = {"ImagingSonarSensor/prim_path"};  // the only argument without a default
  return schema;
}

// github.com/gazebosim/sdformat at 2ace536: sdf/1.9/sensor.sdf and sdf/1.9/lidar.sdf, with what they mark as
// required="1".
inline Schema GazeboSchema() {
  Schema schema;
  schema.known = {"@name", "@type",          "always_on", "update_rate", "visualize",
                  "topic", "enable_metrics", "pose",      "lidar",       "lidar/scan"};
  for (const char* axis : {"horizontal", "vertical"}) {
    const std::string path = std::string("lidar/scan/") + axis;
    schema.known.insert(path);
    for (const char* element : {"samples", "resolution", "min_angle", "max_angle"})
      schema.known.insert(path + "/" + element);
  }
  for (const char* element : {"range", "range/min", "range/max", "range/resolution", "noise", "noise/type",
                              "noise/mean", "noise/stddev", "visibility_mask"}) {
    schema.known.insert(std::string("lidar/") + element);
  }
  schema.required = {"@name",
                     "@type",
                     "lidar/scan/horizontal/samples",
                     "lidar/scan/horizontal/resolution",
                     "lidar/scan/horizontal/min_angle",
                     "lidar/scan/horizontal/max_angle",
                     "lidar/scan/vertical/samples",
                     "lidar/scan/vertical/min_angle",
                     "lidar/scan/vertical/max_angle",
                     "lidar/range/min",
                     "lidar/range/max"};
  return schema;
}

}  // namespace sonarcal::testing
