#!/usr/bin/env bash
# Starts a Slurm of one node on this machine, runs a command that may submit jobs to it, and stops it.
# Needs root, and Debian's packages slurm-wlm and munge; the daemons of an installed Slurm are not touched.
#
#   test/systems/run_on_slurm.sh FOLDER COMMAND...
#
# FOLDER is removed first; it gets the configuration and the logs. jobs.txt has the state of every job. For example:
#   test/systems/run_on_slurm.sh slurm_folder snakemake --profile examples/plot_workflow/profiles/slurm \
#     --snakefile examples/plot_workflow/Snakefile --directory PLOT
set -euo pipefail

if [[ $# -lt 2 ]]; then
  sed -n '2,9s/^# \{0,1\}//p' "$0"
  exit 2
fi
rm -rf "$1"
mkdir -p "$1"/{state,spool,log}
folder=$(realpath "$1")
shift
node=$(hostname -s)
memory=$(($(awk '/MemTotal/ { print $2 }' /proc/meminfo) * 9 / 10240)) # MB, nine tenths of all
port=$((20000 + RANDOM % 10000))
export SLURM_CONF=$folder/slurm.conf

cat > "$SLURM_CONF" <<END
ClusterName=test
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MinJobAge=86400
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory
PartitionName=main Nodes=$node Default=YES MaxTime=INFINITE State=UP
END

stop() {
  local daemon
  for daemon in slurmd slurmctld munged; do
    [[ -s $folder/$daemon.pid ]] && kill "$(< "$folder/$daemon.pid")" 2> /dev/null
  done
  return 0
}
trap stop EXIT

(umask 077 && head -c 1024 /dev/urandom > "$folder/munge.key")
munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
  --log-file="$folder/log/munged.log" --seed-file="$folder/munge.seed" 2>> "$folder/log/start.log"
slurmctld -f "$SLURM_CONF"
slurmd -f "$SLURM_CONF"
for _ in $(seq 60); do
  [[ $(sinfo --noheader --format=%t 2> /dev/null) == idle ]] && break
  sleep 1
done
[[ $(sinfo --noheader --format=%t) == idle ]] || { echo "Slurm does not start, see $folder/log" >&2; exit 1; }

code=0
"$@" || code=$?
scontrol show job --oneliner |
  sed -E 's/.*JobId=([0-9]+).* JobName=(\S+).* JobState=(\S+).* RunTime=(\S+).*/\1 \2 \3 \4/' > "$folder/jobs.txt"
completed=$(grep -c COMPLETED "$folder/jobs.txt" || true)
echo "run_on_slurm: exit code $code, $completed of $(wc -l < "$folder/jobs.txt") jobs completed"
exit "$code"
