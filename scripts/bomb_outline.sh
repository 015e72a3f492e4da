#!/bin/sh
# Finds pose and outline of the bomb from its published length and diameter, and evaluates them on frame 1 and on the
# other pose (docs/studies/bomb.md).
#
# usage: SONARCAL_RECORDINGS=... scripts/bomb_outline.sh SONARCAL OUT
#
# SONARCAL is the program. OUT is a folder that does not exist. Each figure is printed as a line of occupancy: eight
# speckled samples, the detector of `compare`, pixels pooled.
set -eu
if [ $# -ne 2 ]; then
  echo "usage: SONARCAL_RECORDINGS=... scripts/bomb_outline.sh SONARCAL OUT" >&2
  exit 2
fi
sonarcal=$1
out=$2
root=$(cd "$(dirname "$0")/.." && pwd)
published=${SONARCAL_RECORDINGS:?}/aris3000_uxo
mkdir "$out"

# Prints the occupancy. Arguments: label, recording, its frame, parameters, scene, poses.
evaluate() {
  folder=$out/evaluate_$1
  python3 "$root/scripts/repeat_frame.py" "$2" "$3" "$6" "$folder"
  "$sonarcal" simulate --quiet --noise --sonar "$folder/real" --params "$4" --scene "$5" \
    --poses "$folder/poses.json" --out "$folder/samples"
  "$sonarcal" compare --quiet --real "$folder/real" --sim "$folder/samples" --out "$folder/compared" > "$folder/compared.txt"
  echo "$1"
  sed -n 's/^  \(Ns\/Nr\|Na\/Ns\|Na\/Nr\|IoU\) /&/p' "$folder/compared.txt"
}

python3 "$root/scripts/make_aris3000_recording.py" "$published" "$out/recording"
python3 "$root/scripts/make_aris3000_recording.py" "$published" "$out/other" --other-pose "$root/cases/bomb/case.json"

# Plain outline: pose from frame 0, and from the other pose.
"$sonarcal" locate --quiet --real "$out/recording" --target "$root/cases/bomb/body.json" --out "$out/located"
"$sonarcal" locate --quiet --real "$out/other" --target "$root/cases/bomb/body.json" --out "$out/located_other"
evaluate plain_frame_1 "$out/recording" 1 "$out/located/params.json" "$out/located/scene.gltf" "$out/located/poses.json"
evaluate plain_other_pose "$out/other" 0 "$out/located_other/params.json" "$out/located_other/scene.gltf" \
  "$out/located_other/poses.json"

# Outline fitted to frame 0. On the other pose only pose, gain, display and side lobes are found again.
"$sonarcal" fit --quiet --real "$out/located/recording" --scene "$out/located/scene.gltf" --params "$out/located/params.json" \
  --config "$root/cases/bomb/outline.json" --starts 1 --out "$out/fitted"
"$sonarcal" locate --quiet --real "$out/other" --target "$out/fitted/scene.gltf" --out "$out/fitted_other"
evaluate fitted_frame_1 "$out/recording" 1 "$out/fitted/params.json" "$out/fitted/scene.gltf" "$out/fitted/poses.json"
evaluate fitted_other_pose "$out/other" 0 "$out/fitted_other/params.json" "$out/fitted/scene.gltf" \
  "$out/fitted_other/poses.json"

# The other way round: outline fitted to the other pose, pose found again on frame 0.
"$sonarcal" fit --quiet --real "$out/located_other/recording" --scene "$out/located_other/scene.gltf" \
  --params "$out/located_other/params.json" --config "$root/cases/bomb/outline.json" --starts 1 --out "$out/back"
"$sonarcal" locate --quiet --real "$out/recording" --target "$out/back/scene.gltf" --out "$out/back_frame"
evaluate back_frame_1 "$out/recording" 1 "$out/back_frame/params.json" "$out/back/scene.gltf" "$out/back_frame/poses.json"
