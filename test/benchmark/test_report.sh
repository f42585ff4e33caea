#!/bin/bash
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
# The report of the benchmarks contains tables, a plot, failures and recorded figures.
#   test_report.sh REPORT_PY FOLDER
set -eu
report=$1 folder=$2
rm -rf "$folder"
mkdir -p "$folder/programs"
program() {
  printf '#!/bin/sh\n%s\n' "$2" > "$folder/programs/$1"
  chmod +x "$folder/programs/$1"
}
fail() {
  echo "FAILED: $1"
  exit 1
}
program bench_scaling 'cat <<END
| algorithm | points | seconds | kNN [s] | / kNN |
|-----------|--------|---------|---------|-------|
| skeleton  | 10000  | 0.5     | 0.1     | 5     |
| skeleton  | 100000 | 6       | 1.2     | 5     |
END'
program bench_skeleton 'echo "a < b"; echo "no scan" >&2; exit 3'
printf 'program,quantity,value,source,date\nAnother,seconds,12,its paper,2020-01-01\n' > "$folder/o.csv"
status=0
python3 "$report" --programs "$folder/programs" --output "$folder/out" --quick --most 7 \
  --recorded "$folder/o.csv" > "$folder/log" 2>&1 || status=$?
[ $status = 1 ] || fail "status $status, expected 1: programs are missing"
page=$folder/out/report.html
grep -q '<svg' "$page" || fail "no plot"
grep -q 'bench_scaling --most 7' "$page" || fail "no command"
grep -q '<td>100000</td>' "$page" || fail "no table"
grep -q 'exit code 3: no scan' "$page" || fail "no reason of a failure"
grep -q 'a &lt; b' "$page" || fail "text is not escaped"
grep -q 'the program was not built' "$page" || fail "no missing program"
grep -q 'its paper' "$page" || fail "no recorded figure"
python3 -c "
import json, sys
report = json.load(open(sys.argv[1]))
assert len(report['results']) == 4 and report['results'][0]['tables'][0][2][1] == '100000'
" "$folder/out/report.json" || fail "JSON"
echo passed
