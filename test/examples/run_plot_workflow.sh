#!/usr/bin/env bash
# Tests examples/plot_workflow: a virtual plot of four trees, with --cores 1 and --cores 2, with a damaged tile, after
# the damage is repaired, with a damaged scan, and with damaged tiles only.
#
#   test/examples/run_plot_workflow.sh PROGRAMS FOLDER
#
# PROGRAMS is the folder of the built programs; FOLDER is removed first. Needs snakemake, else it prints SKIPPED.
set -euo pipefail

if [[ $# -ne 2 ]]; then
  sed -n '2,8s/^# \{0,1\}//p' "$0"
  exit 2
fi
command -v snakemake > /dev/null || { echo "SKIPPED: snakemake is not installed"; exit 0; }
programs=$(realpath "$1")
workflow=$(realpath "$(dirname "$0")/../../examples/plot_workflow")
rm -rf "$2"
mkdir -p "$2/scans"
cd "$2"

fail() {
  echo "FAILED: $1" >&2
  exit 1
}

# run NAME ARGUMENT...: in the folder NAME; prints the end of the log if the exit code is not $expected
run() {
  local name=$1 code=0
  shift
  mkdir -p "$name"
  snakemake --snakefile "$workflow/Snakefile" --directory "$name" --configfile plot.yaml "$@" \
    > "$name.log" 2>&1 || code=$?
  [[ $code -eq $expected ]] || { tail -n 40 "$name.log" >&2; fail "$name $*: exit code $code"; }
}

# same A B: all results of two folders are equal
same() {
  local file
  for file in results/{trees.csv,{trees,crowns}.geojson,map.svg,failures.csv} merged/{trees.csv,labelled.ply}; do
    cmp "$1/$file" "$2/$file" || fail "$1 and $2 differ"
  done
}

# Four trees at the corners of a square of 9 m, in UTM coordinates, on a slope.
for i in 0 1 2 3; do
  "$programs/virtual_scan" --preset broadleaf --seed $((i + 1)) --height $((5 + i)) --step-degrees 0.2 \
    --ground 6 --output one.xyz --quiet
  awk -v dx=$((500000 + i % 2 * 9)) -v dy=$((5400000 + i / 2 * 9)) \
    'NR == 1 { print; next } { printf "%.4f %.4f %.4f %d %d\n", $1 + dx, $2 + dy,
     $3 + 300 + 0.08 * ($1 + dx - 500000), $4, $5 }' one.xyz > "scans/scan_$i.xyz"
done
cat > plot.yaml <<END
inputs: ["../scans/*.xyz"]
programs: "$programs"
epsg: 25832
tile_points: 150000
group_trees: 2
END

expected=0
run one --cores 1
run two --cores 2
same one two
# Every corner has a tree with all values, within 10 cm.
for corner in 500000,5400000 500009,5400000 500000,5400009 500009,5400009; do
  awk -F, -v x="${corner%,*}" -v y="${corner#*,}" \
    'NR > 1 && ($2 - x) ^ 2 + ($3 - y) ^ 2 < 0.01 && $5 > 0 && $6 > 0 && $8 > 0 && $10 > 0 { n++ }
     END { exit !n }' one/results/trees.csv || fail "there is no tree at $corner"
done
grep -q "EPSG::25832" one/results/trees.geojson || fail "the coordinate system is lost"
awk -F, 'NR > 1 && $5 > 0 && !($11 > 1 && $12 > 1 && $12 < $11 * $7) { n++ } END { exit n > 0 }' \
  one/results/trees.csv || fail "a crown is missing, or larger than its area times the height of the tree"
[[ $(grep -c "<polygon" one/results/map.svg) -eq $(($(wc -l < one/results/trees.csv) - 1)) ]] || fail "the map has no crowns"
[[ $(wc -l < one/results/failures.csv) -eq 1 ]] || fail "there are failures"

# A damaged tile: it is named, the rest is complete, and the exit code is 1.
run bad --cores 1 tiles/tiles.json
cp -p bad/tiles/tile_0001.ply whole.ply
truncate -s 100000 bad/tiles/tile_0001.ply
expected=1
run bad --cores 2
[[ $(grep -c "^segment,tile_0001," bad/results/failures.csv) -eq 1 ]] || fail "the tile is not named"
[[ $(grep -c ",complete," bad/results/trees.csv) -ge 2 ]] || fail "other trees are lost"

# Repaired: the same results as without damage.
cp -p whole.ply bad/tiles/tile_0001.ply
expected=0
run bad --cores 1 repeat_failures
run bad --cores 2
same one bad

# A damaged scan that is left out: it is named in the tables, and the other scans have the same labels as without it.
mkdir -p damaged
printf 'ply\nformat ascii 1.0\nelement vertex 2\n' > damaged/cut.ply
inputs='inputs=["../damaged/*","../scans/*.xyz"]'
expected=1
run scan --cores 1 --config "$inputs"
grep -q "Without tiles" scan.log || fail "a damaged scan does not end the run by default"
run scan --cores 2 --config "$inputs" skip_damaged=true
[[ $(grep -c "^tile,../damaged/cut.ply," scan/results/failures.csv) -eq 1 ]] || fail "the scan is not named"
trees=$(($(wc -l < one/results/trees.csv) - 1))
[[ $(grep -c "the damaged scan ../damaged/cut.ply" scan/results/trees.csv) -eq $trees ]] ||
  fail "the table does not say that the plot is incomplete"
cmp one/merged/labelled.ply scan/merged/labelled.ply || fail "labels differ without the damaged scan"
rm damaged/cut.ply
expected=0
run scan --cores 1 repeat_failures --config "$inputs" skip_damaged=true
run scan --cores 1 --config "$inputs" skip_damaged=true
same one scan

# Thinned: all points have a tree, and the trees are the same.
run thin --cores 2 --config voxel=0.03
points=$(head -c 2000 one/merged/labelled.ply | grep -a "^element vertex")
[[ $(head -c 2000 thin/merged/labelled.ply | grep -a "^element vertex") == "$points" ]] || fail "thinning loses points"
[[ $(wc -l < thin/results/trees.csv) -eq $(wc -l < one/results/trees.csv) ]] || fail "thinning changes the trees"

# All tiles are damaged: the message does not say that results are complete.
expected=0
run none --cores 1 tiles/tiles.json
truncate -s 1000 none/tiles/tile_*.ply
expected=1
run none --cores 1
grep -q "the tables and the map have no trees" none.log || fail "the message does not say that there are no trees"
echo "the plot workflow passed"
