#!/usr/bin/env bash
# Records what the programs write: one SHA-256 a file, for a list of runs that covers the paths of the code.
#
#   test/outputs/record_outputs.sh PROGRAMS OUTPUT [DATA]
#
# PROGRAMS is the folder of the built programs, OUTPUT a folder that must not exist yet, DATA the folder of public
# scans (trees/, trees_public/, stands/, deform/, orl/); without it only generated input is used. Results go to
# OUTPUT/results, their sums to OUTPUT/sums.txt. Two versions of the library agree where their sums.txt are equal:
#
#   diff before/sums.txt after/sums.txt
#
# Reports and tables are compared by their values: seconds, versions and keys are taken out, so that a new name of a
# key is no difference. Options and keys that were renamed are listed in test/outputs/renamed.md.
set -uo pipefail

programs=$(realpath "$1")
output=$2
data=${3:-}
[[ -n $data ]] && data=$(realpath "$data")
[[ -e $output ]] && { echo "$output exists" >&2; exit 2; }
mkdir -p "$output/results"
output=$(realpath "$output")
cd "$output/results" || exit 2

# run NAME PROGRAM ARGUMENT...: a line of the log tells when a run fails; some are meant to
run() {
  local name=$1 program=$2
  shift 2
  "$programs/$program" "$@" > "$name.log" 2>&1
  echo "exit $?" > "$name.exit"
  rm -f "$name.log"
}

# whether the help of a program has a word (not by a pipe, which ends with an error when grep is content early)
knows() { # PROGRAM WORD
  local text
  text=$("$programs/$1" --help 2> /dev/null)
  [[ $text == *"$2"* ]]
}

skeleton() { # NAME SCAN ARGUMENT...
  local name=$1 scan=$2
  shift 2
  local one=()
  # resampled copies of the scan do not change the tree
  knows extract_tree_skeleton --resamples && one=(--resamples 0)
  run "$name" extract_tree_skeleton --input "$scan" --swc "$name.swc" --report "$name.json" --quiet "${one[@]}" "$@"
}

# the option NEW if the program knows it, else OLD: options that were renamed
option() { # PROGRAM NEW OLD
  if knows "$1" "$2"; then echo "$2"; else echo "$3"; fi
}

# ---- virtual trees: the two scans of ./run, one with leaves and ground, one coarse from one side
run broadleaf virtual_scan --preset broadleaf --stations 4 --seed 7 --output broadleaf.ply \
  --truth broadleaf.csv --swc broadleaf_truth.swc --report broadleaf.json
run fruit virtual_scan --preset fruit --stations 4 --seed 8 --output fruit.ply --truth fruit.csv \
  --swc fruit_truth.swc
run leafy virtual_scan --preset fruit --stations 3 --seed 5 --step-degrees 0.1 --leaves 60 --ground 4 \
  --outliers 0.001 --ghosts 0.3 --output leafy.ply
run coarse virtual_scan --preset broadleaf --stations 1 --seed 9 --step-degrees 0.25 --registration 0.005 \
  --voxel 0.01 --output coarse.ply

skeleton broadleaf_skeleton broadleaf.ply --mesh broadleaf_mesh.ply --cylinders broadleaf_cylinders.csv \
  --points broadleaf_points.ply --edges broadleaf_edges.ply --leaves broadleaf_leaves.ply
skeleton fruit_skeleton fruit.ply --cylinders fruit_cylinders.csv
skeleton leafy_skeleton leafy.ply --points leafy_points.ply
skeleton leafy_kept leafy.ply --keep-leaves --keep-ground
skeleton coarse_skeleton coarse.ply --scanner 8 0 1.5 --mesh coarse_mesh.ply --separate
skeleton fruit_sections fruit.ply --method sections
skeleton fruit_all_points fruit.ply --method sections --fit ellipse --all-points --no-support
skeleton fruit_given fruit.ply --skeleton fruit_truth.swc
skeleton fruit_unmoved fruit.ply --keep-stations --root 0 0 0 --remove-leaves

if [[ -n $data ]]; then
  for tree in trees/broadleaf_arbor trees/pine_treels trees/branch_a3b4_plantscan3d trees/leafon_rc151_gbs \
    trees/sapling_rtwig trees/sparse_archi trees/small_dense_archi trees/stem_itsme trees/synth_sparse \
    trees/tropical_treegraph trees_public/conifer_tls1 trees_public/street_tree7; do
    name=$(basename "$tree")
    skeleton "$name" "$data/$tree.ply" --points "${name}_points.ply" --cylinders "${name}_cylinders.csv"
  done
  skeleton a3b4_sections "$data/trees/branch_a3b4_plantscan3d.ply" --method sections --fit by_arc
  run stand segment_trees --input "$data/stands/tls_clip.ply" --points stand.ply --report stand.json
fi

# ---- deformations: 2000 samples, all points, streamed
cat > edit.json << 'JSON'
{ "handles": [
  { "select": { "box": [[-9, -9, -9], [9, 9, 1]] }, "fixed": true },
  { "select": { "box": [[-9, -9, 5], [9, 9, 99]] },
    "rotate": { "axis": [1, 0, 0], "degrees": 40, "center": [0, 0, 3] }, "translate": [0.2, 0, 0.1] } ] }
JSON
run bend deform_point_set --input broadleaf.ply --edit edit.json --samples 2000 --output bend.ply --report bend.json
run bend_all deform_point_set --input coarse.ply --edit edit.json --samples 1000000 --output bend_all.ply
run bend_default deform_point_set --input fruit.ply --default-edit --output bend_default.ply
run bend_stream deform_point_set --input broadleaf.ply --edit edit.json --samples 1500 --stream \
  --stream-points 20000 --output bend_stream.ply
if [[ -n $data ]]; then
  run bunny deform_point_set --input "$data/deform/bunny_35947.ply" --default-edit --samples 3000 --output bunny.ply
fi

# ---- shape space: two morphs, and a family with all that is made of one
run morph orl_geodesic --tree broadleaf.ply --skeleton broadleaf_truth.swc --tree fruit.ply \
  --skeleton fruit_truth.swc --lambda=-0.2,0,0.25,0.5,1,1.3 --output morph --matches morph.csv --report morph.json \
  --correspondences morph_correspondences.csv
for age in 0.6 0.8 1; do
  run "age_$age" virtual_scan --preset fruit --seed 3 --age $age --stations 2 --step-degrees 0.2 --output "age_$age.ply" \
    --swc "age_$age.swc"
done
run young orl_geodesic --tree age_0.6.ply --skeleton age_0.6.swc --tree age_1.ply --skeleton age_1.swc --lambda 0.5 \
  --transport sinkhorn --align "$(option orl_geodesic yaw turns)" --extend-axes \
  "$(option orl_geodesic --sequential-emergence --births-in-order)" \
  --limit-radii --mesh --changes young_changes.csv --output young
family=(--skeleton age_0.6.swc --skeleton age_0.8.swc --skeleton age_1.swc)
run family orl_geodesic "${family[@]}" --mean --modes 2 --sample 3 --seed 4 --pipe-model 2.5 --growth --frames 4 \
  --monotone --distances family.csv --save-space family.space --output family --report family_report.json
run loaded orl_geodesic --load-space family.space --mean --sample 2 --seed 5 --output loaded
if [[ -n $data ]]; then
  run botanical orl_geodesic --skeleton "$data/orl/skel_botanical/AL06a.txtskl" \
    --skeleton "$data/orl/skel_botanical/BS07a.txtskl" --published-energy --lambda 0.3,0.7 --output botanical \
    --matches botanical.csv --up y
fi

# ---- sums; of JSON the numbers and texts without keys, seconds, bytes and versions; of CSV the rows
values() {
  case $1 in
    *.json | *.jsonl) sed -E '/"seconds": ?\{/,/\}/d; /"[a-z_]*(seconds|bytes|memory|version)[A-Za-z_]*":/d; s/"[A-Za-z_0-9 ]+": ?//' "$1" ;;
    *.csv) tail -n +2 "$1" ;;
    *.space) tail -c +64 "$1" ;;
    *) cat "$1" ;;
  esac
}
find . -type f ! -name edit.json | sort | while read -r file; do
  printf '%s  %s\n' "$(values "$file" | sha256sum | cut -d' ' -f1)" "$file"
done > "$output/sums.txt"
wc -l < "$output/sums.txt"
