#!/usr/bin/env bash
# Makes a minimal Debian system in a folder, and runs the commands of the README in it.
# Needs root and debootstrap. Takes about half an hour, and 6 GB of disk.
#
#   test/systems/run_in_debian.sh RELEASE FOLDER [COMMAND...]
#
# RELEASE is bookworm (Debian 12) or trixie (Debian 13). COMMAND is run by a shell in a copy of
# this repository; the default is: ./run && ./run test
set -euo pipefail

if [[ $# -lt 2 ]]; then
  sed -n '2,9s/^# \{0,1\}//p' "$0"
  exit 2
fi
release=$1
folder=$2
shift 2
source=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)

if [[ ! -e $folder/etc/debian_version ]]; then
  debootstrap --variant=minbase --include=ca-certificates "$release" "$folder"
fi
mkdir -p "$folder/root/pcs"
git -C "$source" archive HEAD | tar xf - -C "$folder/root/pcs"

mount --bind /proc "$folder/proc"
mount --bind /dev "$folder/dev"
trap 'umount "$folder/proc" "$folder/dev"' EXIT
begin=$SECONDS
# resolv.conf: the packages come from the network
cp -L /etc/resolv.conf "$folder/etc/resolv.conf"
chroot "$folder" /bin/sh -c "cd /root/pcs && ${*:-./run && ./run test}"
echo "run_in_debian: $release, CGAL $(chroot "$folder" dpkg-query -W -f '${Version}' libcgal-dev)," \
     "$(chroot "$folder" g++ -dumpfullversion), $(((SECONDS - begin) / 60)) minutes"
